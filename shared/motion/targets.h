#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/motion/time_line.h"
#include "shared/motion/validity.h"

namespace tessera {

/// A place in texels of level 0.
struct MotionPoint {
    std::int64_t x = 0;  ///< Within ±2^40, as y.
    std::int64_t y = 0;
};

/// A target that moves by itself: from point to point, evenly and exactly between them, then from the first
/// on again. Its position is a function of the step.
class MovingTarget {
  public:
    struct Leg {
        MotionPoint from;
        std::uint32_t steps = 1;  ///< To the next leg's start; the last leg ends where the first begins.
    };
    /// `legs`: at least one, at most 65536, each of 1 to 2^28 steps. The first begins at step `first`.
    MovingTarget(std::span<const Leg> legs, Step first);

    /// Where it is: (x, y) / parts of a texel.
    struct Place {
        std::int64_t x = 0, y = 0;  ///< In texels, rounded down.
        std::int64_t x_rest = 0, y_rest = 0;
        std::int64_t parts = 1;
    };
    Place at(Step step) const noexcept;

    /// A leg as it is walked once: the step at which it begins, and where from and by how much it leads.
    struct Walk {
        Step begin = 0;
        std::int64_t steps = 1;
        MotionPoint from, by;
    };
    Walk walk_at(Step step) const noexcept;

    std::int64_t round_steps() const noexcept { return begins_.back(); }  ///< Until it comes round again.

  private:
    std::vector<Leg> legs_;
    std::vector<std::int64_t> begins_;  ///< Of each leg in the round; and the round's length.
    Step first_;
};

/// Frames by distance to the nearest target ("triggered by the distance to the two balls", figure 21 a): at
/// `far` texels and beyond the first frame, towards `near` the last, each for as much of the way between as
/// it has steps in the time line. Frames go up and down with the distance; one is left out only where a
/// target moves by more than a frame's share of the way in a step.
class TargetDistance {
  public:
    /// 0 <= near < far <= 2^28. Copies the targets, at most 256; all come round in the same number of steps.
    TargetDistance(const TimeLine& line, std::int64_t near, std::int64_t far,
                   std::span<const MovingTarget> targets);

    std::int32_t frame_at(MotionPoint cell, Step step) const noexcept;
    /// The frame, and where it changed last and changes next: found on each leg by bisection, since the
    /// distance to a place falls and then rises along a straight line.
    struct Answer {
        std::int32_t frame = 0;
        Validity validity{};
    };
    Answer shown_at(MotionPoint cell, Step step) const noexcept;

  private:
    /// The frame along a walk, `moved` steps (0 to walk.steps) after its beginning.
    std::int32_t frame_on(const MovingTarget::Walk& walk, MotionPoint cell,
                          std::int64_t moved) const noexcept;
    Step next_change(const MovingTarget& target, MotionPoint cell, Step step) const noexcept;
    Step last_change(const MovingTarget& target, MotionPoint cell, Step step) const noexcept;

    std::vector<std::int64_t> reach_;  ///< Frame i + 1 is shown at distances up to reach_[i].
    std::vector<MovingTarget> targets_;
};

}  // namespace tessera
