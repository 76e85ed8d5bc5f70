#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "client/residency/lifted_sprites.h"
#include "client/residency/page_holds.h"
#include "client/residency/page_table.h"
#include "client/residency/slot_cache.h"
#include "client/residency/slot_upload.h"

namespace tessera {

/// Pages without the sprites that a hand has lifted from them: shown instead of the pages themselves, out of
/// slots of their own, for as long as a hold says so. What the pages show meanwhile goes on underneath, and
/// is there at once afterwards.
///
/// Where more pages are touched than there are slots, a coarser stand-in serves for several: what lies around
/// the hand's sprites is a little blurred then, which is better than a sprite seen twice. Where pages would
/// have to be without more sprites than servers leave out, a hold lifts nothing: the pages show its sprites
/// where they were, and the hand does not draw them (unlifted_holds()) until all is swapped at once.
class StandIns {
  public:
    /// Ids of requests for stand-ins have this bit; those of others have not.
    static constexpr PageRequestId id_bit = PageRequestId{1} << 31;
    static bool is_one(PageRequestId id) { return (id & id_bit) != 0; }

    /// Of the slots: a few coarse ones that cover everything, so that there is something to show wherever
    /// the view goes; and as many for those of a view that has passed, until these have come.
    static constexpr std::size_t most_covers = 4;
    /// `source` outlives this. `most`: slots, behind those of the cache. With no more than
    /// 2 × most_covers of them, sprites may be seen twice.
    StandIns(PageSource& source, std::size_t most) : source_{source}, most_{most} {}

    std::size_t most() const { return most_; }
    /// Answers that came.
    void hear(std::vector<ArrivedPage> arrived);

    /// Once a frame, after the table and the cache are what they are for it: asks for what is missing, and
    /// has the table show what is there. Returns what to upload before the frame is drawn.
    std::vector<SlotUpload> update(std::span<const NeededPage> needed, std::span<const PageHold> holds,
                                   const SlotCache& cache, const PageVersions& versions, Step step,
                                   PageTable& table);
    /// Holds of the last update() that lift nothing, because too much is lifted.
    const std::vector<std::uint32_t>& unlifted_holds() const { return unlifted_; }
    /// Whether all that is shown now would be right when `hold` has ended and `others` have not.
    bool outlive(const PageHold& hold, const std::vector<const PageHold*>& others) const;
    /// Shows every page itself again.
    void clear(PageTable& table);

  private:
    /// What a stand-in is made of: another one takes its place where this changes.
    struct Made {
        LiftedFrom lifted;
        std::uint32_t history = 0;
        std::uint64_t revision = 0;
        Step from = 0;
        bool operator==(const Made&) const = default;
    };
    struct Entry {
        std::size_t index = 0;         ///< Of its slot
        PageRequestId asked = 0;       ///< 0: nothing is under way
        Made wanted{};                 ///< What was asked for last
        LiftedFrom there{};            ///< What the slot holds …
        bool is_there = false;         ///< … if anything
        std::string texels{};          ///< Come, and not uploaded yet
        int failures = 0;              ///< In a row: it is left alone for a growing while
        std::uint64_t not_before = 0;  ///< Frame
        bool is_wanted = false;
    };
    /// A resident page that is sampled and shows what is lifted.
    struct Touched {
        double pixels = 0;
        Made made;  ///< As its own stand-in would be
    };
    using Pages = std::map<PageKey, Touched>;
    struct Plan {
        std::vector<const PageHold*> holds;  ///< That lift
        Pages pages;
        std::vector<PageKey> wanted;  ///< Stand-ins, the most urgent first
    };

    /// Slots for those that make the covers sharper.
    std::size_t most_targets() const { return std::max(most_, 2 * most_covers + 1) - 2 * most_covers; }
    Plan plan(std::span<const NeededPage> needed, std::span<const PageHold> holds, const SlotCache& cache,
              const PageVersions& versions, const PageTable& table) const;
    void claim(const Plan& plan);
    void make_room(const Plan& plan);
    void ask(const Plan& plan, Step step);
    std::vector<SlotUpload> bring(std::size_t first_slot);
    void show(const Plan& plan, std::size_t first_slot, PageTable& table);
    void let_go(PageKey stand_in);
    const PageKey* best_for(PageKey page, const Plan& plan, const PageKey* but = nullptr) const;

    PageSource& source_;
    std::size_t most_;
    std::map<PageKey, Entry> entries_;
    std::map<PageKey, PageKey> shown_;  ///< Pages, and the stand-ins that are shown instead
    std::vector<std::uint32_t> unlifted_;
    std::uint64_t frame_ = 0;
    PageRequestId next_id_ = 1;
};

}  // namespace tessera
