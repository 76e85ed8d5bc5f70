#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "client/residency/slot.h"
#include "shared/page/page_key.h"

namespace tessera {

/// Which page is in which slot. Least recently used pages leave first, with a second chance: a page that was
/// used since it was last looked at is passed over once. A page used in the present frame and a pinned page
/// never leave.
class SlotCache {
  public:
    /// `slots`: 1 to 65,534.
    explicit SlotCache(std::size_t slots);

    /// Starts the next frame: nothing counts as used in it yet.
    void begin_frame() { ++frame_; }

    std::optional<Slot> find(PageKey page) const;
    /// The slot's page is shown in the present frame.
    void use(Slot slot);
    /// The slot's page is of use, but may leave if nothing else can.
    void touch(Slot slot) { slots_[slot].used = true; }

    struct Placement {
        Slot slot = 0;
        std::optional<PageKey> evicted;  ///< The page that was in this slot.
    };
    /// Finds a slot for a page that has none. Nothing if every slot is pinned or used in the present frame.
    std::optional<Placement> insert(PageKey page, bool pinned);

    /// The page is in no slot any more; one that is not pinned.
    void remove(PageKey page);

    struct Move {
        PageKey page;
        Slot from = 0;
        Slot to = 0;
    };
    struct Resized {
        std::vector<Move> moves;       ///< All at once: no slot is both left and taken.
        std::vector<PageKey> dropped;  ///< The longest unused; no pinned ones.
    };
    /// From now on so many slots; at least as many as there are pinned pages, and one.
    Resized resize(std::size_t slots);

    std::size_t capacity() const { return slots_.size(); }
    std::size_t size() const { return slot_of_.size(); }
    std::size_t pinned() const { return pinned_; }
    std::uint64_t evictions() const { return evictions_; }
    /// In no order.
    const std::unordered_map<PageKey, Slot>& pages() const { return slot_of_; }

  private:
    struct Entry {
        PageKey page;
        std::uint64_t used_in_frame = 0;
        bool used = false;  ///< Since it was last looked at for eviction
        bool pinned = false;
    };
    std::optional<Slot> victim();

    std::vector<Entry> slots_;
    std::vector<Slot> free_;   ///< The lowest last
    std::vector<Slot> order_;  ///< A ring of the filled, unpinned slots
    std::size_t hand_ = 0;     ///< Of order_: looked at next
    std::unordered_map<PageKey, Slot> slot_of_;
    std::size_t pinned_ = 0;
    std::uint64_t frame_ = 1;
    std::uint64_t evictions_ = 0;
};

}  // namespace tessera
