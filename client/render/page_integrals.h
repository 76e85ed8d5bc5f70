#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "client/render/integral_store.h"
#include "client/residency/page_table.h"
#include "client/residency/slot.h"

namespace tessera {

/// Line integrals of the pages that are shown: they take seven times a page's room, and most pages of a cache
/// are not in the picture. Slots' pages have them in places of an IntegralStore, the longest unshown make
/// room, and a page table of its own leads to them (PageTableTexture says what its bytes are, with places for
/// slots): where a page has none, to its finest ancestor that has.
class PageIntegrals {
  public:
    /// Needs a current context. `slots`: of the cache.
    PageIntegrals(Extent extent, int window_side, std::size_t slots);

    /// Starts the next frame, which shows the pages in these slots: there are places for all of them from now
    /// on. Error: io_failure with what to do; nothing has changed then.
    Result<void> begin_frame(std::span<const Slot> shown);
    /// Another page is in the slot, or another version of it.
    void forget(Slot slot);
    /// The same, and its texels are at hand: slot_bytes. Without a place to spare it stays without sums.
    void upload(Slot slot, std::string_view texels);
    /// Before the frame is drawn: sums up what it shows and nobody has summed up, from pages on the GPU as
    /// codes (RGBA8), and brings the table over. `coarsest_changed`: entries of this level and finer ones may
    /// have changed since the last call; −1: none.
    void bring(GLuint coded_pages, const PageTable& table, int coarsest_changed);

    GLuint texture() const { return store_ ? store_->texture() : 0; }
    GLuint table() const { return table_.name(); }
    std::size_t places() const { return places_.size(); }
    std::size_t bytes() const { return store_ ? store_->bytes() : 0; }

  private:
    static constexpr int none = -1;
    struct Place {
        int slot = none;
        std::uint64_t frame = 0;  ///< In which it was shown last
    };
    struct Summed {
        int place = none;
        std::uint64_t frame = 0;  ///< In which the slot was shown last
    };
    Result<void> grow(std::size_t places);
    /// A place for the slot's page: its own, a free one, or that of a page that this frame does not show.
    int take_place(Slot slot);
    void bring_table(const PageTable& table, int coarsest);

    std::unique_ptr<IntegralStore> store_;
    std::vector<Place> places_;
    std::vector<Summed> slots_;
    std::vector<Slot> shown_;
    std::uint64_t frame_ = 1;
    bool moved_ = true;  ///< Some page got a place or lost it since the table was brought
    int window_side_;
    GlTexture table_;
    std::vector<std::vector<std::uint32_t>> entries_;  ///< [level]: as the GPU has them
};

}  // namespace tessera
