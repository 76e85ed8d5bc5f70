#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "server/blocks/plan.h"
#include "server/pattern/scroll_watch.h"

namespace tessera {

/// The looks of a rectangle of cells, a row at a time.
class CellLooks {
  public:
    /// Cells from (x, y) on, in layer `z` of the grid's cells, at the step of `of` and with what drives it.
    /// `plan` and `watch`, which is told of all rows, live longer.
    CellLooks(const ReferencePlan& plan, const TexelRegion& of, std::int64_t z, std::int64_t x,
              std::int64_t y, std::int32_t width, std::int32_t height, ScrollWatch* watch = nullptr)
        : plan_{plan},
          watch_{watch},
          step_{of.step},
          parameter_{of.parameter},
          targets_{of.targets},
          x_{x},
          z_{z},
          width_{width},
          looks_(static_cast<std::size_t>(width)) {
        if (plan.program->needs_types()) types_ = plan.grid.quadtree->types_of(0, x, y, width, height, z);
    }

    /// Valid until the next row is asked for.
    const Look* row(std::int64_t y) {
        constexpr std::int32_t at_once = 4096;
        for (std::int32_t from = 0; from < width_; from += at_once) {
            CellRow row{.x = x_ + from,
                        .y = y,
                        .count = std::min(at_once, width_ - from),
                        .z = z_,
                        .step = step_,
                        .validity = watch_ != nullptr ? watch_->frames() : &validity_,
                        .parameter = parameter_,
                        .targets = targets_};
            if (!types_.types.empty()) row.types = types_.row(y) + (x_ - types_.x) + from;
            plan_.program->looks(row, looks_.data() + from);
        }
        if (watch_ != nullptr) watch_->see(x_, y, std::span<const Look>{looks_});
        return looks_.data();
    }

    /// The steps in which all rows that were asked for stay the same where they stand; with a watch it knows.
    const Validity& validity() const noexcept { return validity_; }

  private:
    const ReferencePlan& plan_;
    ScrollWatch* watch_;
    std::int64_t step_;
    std::int32_t parameter_;
    const TargetDistances* targets_;
    std::int64_t x_, z_;
    std::int32_t width_;
    std::vector<Look> looks_;
    TypeGrid types_;
    Validity validity_;
};

}  // namespace tessera
