#pragma once

#include <cstdint>
#include <span>

#include "server/blocks/cell_op.h"
#include "server/blocks/cell_program.h"
#include "server/blocks/scroll.h"
#include "server/blocks/seen_cells.h"
#include "server/blocks/still_runs.h"

namespace tessera {

/// What is known of cells as they are, before they scroll.
class StandingCells {
  public:
    virtual ~StandingCells() = default;
    StandingCells() = default;
    StandingCells(const StandingCells&) = delete;
    StandingCells& operator=(const StandingCells&) = delete;

    /// What each shows, and in which steps its frame is that, as far as it is asked for. All three are as
    /// long.
    virtual void ask(std::span<const CellAt> cells, std::span<Look> looks,
                     std::span<Validity> frames) const = 0;
    /// Leaves out those of a row's cells that are known to show `look`, and no other, in all steps that they
    /// are asked for; those that are left come first, as many as it returns. Sooner told than ask(). Only
    /// where sifts(): else all are left.
    virtual bool sifts() const noexcept { return false; }
    virtual std::size_t sift(std::span<CellAt> cells, const Look&) const { return cells.size(); }
    /// Cells that show one look and no other in the steps that it holds are of one kind.
    struct Still {
        std::shared_ptr<const StillRuns> runs;    ///< Null where nothing is known.
        StillRuns::Kind kind = StillRuns::other;  ///< Of the look that is asked for.
        Validity holds{};
    };
    virtual Still still_at(Step step, const Look& look) const = 0;
    virtual Still still_ever(const Look& look) const = 0;  ///< At every step.
    /// After how many cells of a row they come again, at any step; 0 if nobody knows.
    virtual std::int64_t comes_again() const noexcept = 0;
    virtual bool same(const Look& a, const Look& b) const noexcept = 0;
};

/// The steps around `block.step` in which no place of the block shows anything else, found from shift to
/// shift: at a shift, what places show before and after is compared; between two, frames must stay. Cells
/// that are known to stand still are jumped over. `seen`: what the block shows; `frames`: in which steps its
/// cells' frames stay.
///
/// It never goes on for longer than until the next of some steps that lie up to 2^16 shifts apart (fewer for
/// tall blocks, and a sixteenth of that at steps at which nothing is known of runs; 16 shifts where places
/// show this and that), so that a block at rest for ever costs no more than they do: those steps are the same
/// whatever step is asked for, and so is the interval from all of its steps.
Validity scroll_interval(const Scroll& scroll, const CellBlock& block, const SeenCells& seen,
                         const Validity& frames, const StandingCells& cells);

}  // namespace tessera
