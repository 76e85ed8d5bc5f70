#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "client/residency/page_holds.h"
#include "client/residency/page_table.h"
#include "client/residency/slot_cache.h"
#include "client/residency/slot_upload.h"

namespace tessera {

/// Pages without the sprites that a hand has lifted from them: shown instead of the pages themselves, out of
/// slots of their own, for as long as a hold says so. What the pages show meanwhile goes on underneath, and
/// is there at once afterwards.
class StandIns {
  public:
    /// Ids of requests for stand-ins have this bit; those of others have not.
    static constexpr PageRequestId id_bit = PageRequestId{1} << 31;
    static bool is_one(PageRequestId id) { return (id & id_bit) != 0; }

    /// `source` outlives this. `most`: slots, behind those of the cache.
    StandIns(PageSource& source, std::size_t most) : source_{source}, most_{most} {}

    std::size_t most() const { return most_; }
    /// Answers that came.
    void hear(std::vector<ArrivedPage> arrived);

    /// Once a frame, after the table and the cache are what they are for it: asks for what is missing, and
    /// has the table show what is there. Returns what to upload before the frame is drawn.
    std::vector<SlotUpload> update(std::span<const NeededPage> needed, std::span<const PageHold> holds,
                                   const SlotCache& cache, const PageVersions& versions, Step step,
                                   PageTable& table);
    /// Shows every page itself again.
    void clear(const SlotCache& cache, PageTable& table);

  private:
    /// What a stand-in was made of: another one takes its place where this changes.
    struct Made {
        std::vector<std::uint64_t> without;
        std::uint32_t history = 0;
        std::uint64_t revision = 0;
        Step from = 0;
        bool operator==(const Made&) const = default;
    };
    struct Entry {
        std::size_t index = 0;    ///< Of its slot
        PageRequestId asked = 0;  ///< 0: nothing is under way
        Made wanted;              ///< What was asked for last
        std::string texels;       ///< Come, and not uploaded yet
        bool is_there = false;
        bool is_shown = false;
        bool is_wanted = false;
    };
    void show_itself(PageKey page, Entry& entry, const SlotCache& cache, PageTable& table);

    PageSource& source_;
    std::size_t most_;
    std::unordered_map<PageKey, Entry> entries_;
    PageRequestId next_id_ = 1;
};

}  // namespace tessera
