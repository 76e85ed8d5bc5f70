#pragma once

#include <span>

#include "server/blocks/plan.h"
#include "server/blocks/seen_cells.h"

namespace tessera {

/// Sees the rows of a region's cells, if they scroll, to tell how long they show the same.
class ScrollWatch {
  public:
    /// Of cells from (x, y) on, in layer `z`. `program` lives longer.
    ScrollWatch(const CellProgram& program, const TexelRegion& of, std::int64_t z, std::int64_t x,
                std::int64_t y, std::int64_t width, std::int64_t height)
        : program_{program},
          block_{.x = x,
                 .y = y,
                 .width = static_cast<std::int32_t>(width),
                 .height = static_cast<std::int32_t>(height),
                 .z = z,
                 .step = of.step,
                 .parameter = of.parameter,
                 .targets = of.targets},
          scrolls_{program.scroll().cells != 0},
          seen_{program.scroll().cells} {
        if (!scrolls_) return;
        frames_ = program.scroll().at(of.step).validity;
        // In a shift of one step none can change, and asking each cell how long it stays would tell nothing
        narrows_ = program.scroll().steps > 1;
        if (!narrows_) return;
        // How long frames are shown beyond a shift does not matter, but that they are
        frames_ = {add_steps(frames_.from, -1), add_steps(frames_.until, 1)};
    }

    /// A row of them, or a part of it: patterns, or looks.
    template <class Cell>
    void see(std::int64_t x, std::int64_t y, std::span<const Cell> row) {
        if (scrolls_) seen_.see(x, y, row);
    }
    /// To be narrowed to the steps in which all cells keep their frames where they stand; null where nobody
    /// needs to know.
    Validity* frames() noexcept { return narrows_ ? &frames_ : nullptr; }
    /// Once all rows were seen.
    Validity interval() const { return scrolls_ ? program_.through_shifts(block_, seen_, frames_) : frames_; }

  private:
    const CellProgram& program_;
    CellBlock block_;
    bool scrolls_;
    bool narrows_ = true;
    Validity frames_;
    SeenCells seen_;
};

/// What is told of cells that were asked for one by one, here and there.
inline Validity in_this_shift(const CellProgram& program, Step step, Validity frames) {
    frames.meet(program.scroll().at(step).validity);
    return frames;
}

}  // namespace tessera
