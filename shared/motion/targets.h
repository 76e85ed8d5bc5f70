#pragma once

#include <cstdint>
#include <memory>
#include <optional>
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
    std::span<const Leg> legs() const noexcept { return legs_; }
    bool moves() const noexcept;
    double speed() const noexcept { return speed_; }  ///< The highest, in texels a step: about.

    /// The smallest box with all places of the steps [from, until), which are fewer than a round or all: both
    /// corners are in it.
    struct Box {
        MotionPoint least, most;
    };
    Box box(Step from, Step until) const noexcept;
    Box box() const noexcept { return box_; }  ///< Of all steps.

  private:
    std::vector<Leg> legs_;
    std::vector<std::int64_t> begins_;  ///< Of each leg in the round; and the round's length.
    Step first_;
    Box box_;
    double speed_ = 0;
};

/// Places side by side: (first.x + i · spacing, first.y), i from 0 to count − 1.
struct MotionRow {
    MotionPoint first;
    std::int64_t spacing = 1;  ///< At least 1.
    std::int32_t count = 0;    ///< (count − 1) · spacing is below 2^40.
};

/// Places on a rectangle: (first.x + i · spacing, first.y + j · spacing).
struct MotionLattice {
    MotionPoint first;
    std::int64_t spacing = 1;            ///< At least 1.
    std::int64_t columns = 1, rows = 1;  ///< At least 1; the whole is below 2^41.
};

/// Frames by distance to the nearest target ("triggered by the distance to the two balls", figure 21 a): at
/// `far` texels and beyond the first frame, towards `near` the last, each for as much of the way between as
/// it has steps in the time line (the first, at rest, for one whatever it has). Frames go up and down with
/// the distance; one is left out only where a target moves by more than a frame's share of the way in a step.
class TargetDistance {
  public:
    /// 0 <= near < far <= 2^28. Copies the targets, at most 256; all come round in the same number of steps.
    TargetDistance(const TimeLine& line, std::int64_t near, std::int64_t far,
                   std::span<const MovingTarget> targets);
    /// The same, of targets that several laws share.
    TargetDistance(const TimeLine& line, std::int64_t near, std::int64_t far,
                   std::shared_ptr<const std::vector<MovingTarget>> targets);

    std::int32_t frame_at(MotionPoint cell, Step step) const noexcept;
    /// The frame, and where it changed last and changes next: found on each leg by bisection, since the
    /// distance to a place falls and then rises along a straight line.
    struct Answer {
        std::int32_t frame = 0;
        Validity validity{};
    };
    Answer shown_at(MotionPoint cell, Step step) const noexcept { return shown_at(cell, step, {}); }
    /// The same, of changes that lie inside `within`, which holds at `step`: of others it knows nothing.
    Answer shown_at(MotionPoint cell, Step step, const Validity& within) const noexcept;

    /// frames[i] = frame_at(place i, step). `validity`, if given, holds at `step` and is narrowed to the
    /// steps in which none of these frames changes. Where no target ever comes near this takes no time.
    void shown_along(const MotionRow& row, Step step, std::int32_t* frames, Validity* validity) const;

    /// Where all places show the first frame: the steps around `step` in which they do. None where some show
    /// another, and where that takes long to tell. Takes a few bisections for each leg that comes near.
    std::optional<Validity> rest_of(const MotionLattice& places, Step step) const noexcept;

    /// Narrows `validity`, which holds at `step`, to the steps in which none of the places shows another
    /// frame than at `step`: as shown_along() does row by row, in a few microseconds where rings pass many
    /// rows.
    void narrow(const MotionLattice& places, Step step, Validity& validity) const;

    /// Whether any target may ever be near any place of a box, whose corners are in it: no is certain.
    bool ever_near(MotionPoint least, MotionPoint most) const noexcept;
    std::int64_t reach() const noexcept {
        return reach_.empty() ? -1 : reach_.front();
    }  ///< Beyond: frame 0.
    std::span<const MovingTarget> targets() const noexcept { return *targets_; }

  private:
    /// The frame along a walk, `moved` steps (0 to walk.steps) after its beginning.
    std::int32_t frame_on(const MovingTarget::Walk& walk, MotionPoint cell,
                          std::int64_t moved) const noexcept;
    /// Where a target's own frame changes next; never, if not before `limit`.
    Step next_change(const MovingTarget& target, MotionPoint cell, Step step, Step limit) const noexcept;
    /// Where it changed last; always, if not after `limit`.
    Step last_change(const MovingTarget& target, MotionPoint cell, Step step, Step limit) const noexcept;
    bool ever_near(const MovingTarget& target, MotionPoint cell) const noexcept;
    class Approach;
    class Search;
    bool ever_near(const MovingTarget& target, MotionPoint least, MotionPoint most) const noexcept;
    void frames_of(const MovingTarget& target, const MotionRow& row, Step step,
                   std::span<std::int32_t> frames) const noexcept;
    bool stays_on(const MovingTarget::Walk& walk, MotionPoint cell, std::int32_t frame,
                  const Validity& within) const noexcept;
    void narrow(const MovingTarget& target, const MotionRow& row, Step step,
                std::span<const std::int32_t> frames, Validity& validity) const noexcept;

    std::vector<std::int64_t> reach_;  ///< Frame i + 1 is shown at distances up to reach_[i].
    std::shared_ptr<const std::vector<MovingTarget>> targets_;
    std::int64_t round_ = 1;  ///< Of the targets that move.
};

/// What the animations of a scene see of its targets: one law each.
struct TargetDistances {
    std::vector<TargetDistance> laws;
    bool tell_validity = true;  ///< False where the whole is asked how long it stays as it is, not each row.
};

}  // namespace tessera
