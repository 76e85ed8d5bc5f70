#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shared/motion/cycle.h"

namespace tessera {

/// Temporal transitions (Lefebvre & Neyret 2003, section 3.4, figure 13): parameters change while the
/// animation runs, and no cell jumps. No state is kept per cell; what a cell shows follows from the old and
/// the new parameters and the step t0 of the change:
///
/// - The old cycle runs to its end, t_f = t0 + n − p'(t0). (A cell that rests at t0 has t_f = t0. The paper
///   says t0 − 1; then a cell whose last frame was shown at t0 − 1 can go on with frame 1.)
/// - If the new cycle rests at t_f, it goes on with that. Else the two collide, and the cell rests until the
///   run of the new cycle is over, at t_end = t_f + n − p(t_f).
///
/// So a frame's index only ever stays, goes up by one, or goes from n − 1 to 0, as long as the next change
/// comes no sooner than steps_between_changes(): by then every cell shows the new cycle.

/// How far apart two changes have to be: 2n − 2, and at least 1.
inline std::int64_t steps_between_changes(const TimeLine& line) noexcept {
    return line.run() > 1 ? 2 * line.run() - 2 : 1;
}

/// The steps at which parameters change. A change that is asked for too soon waits until it is safe; of those
/// that wait the latest wins, so that a slider never builds a queue.
class ChangeTimes {
  public:
    explicit ChangeTimes(const TimeLine& line) : between_{steps_between_changes(line)} {}

    /// When a change that is asked for at step `asked` takes effect: up to and including that step cells
    /// still show what they would have without it.
    struct Effect {
        Step step = 0;
        bool replaces = false;  ///< The last change was still waiting: this one is in its place.
    };
    /// Adds it. `asked` is at least that of the calls before.
    Effect add(Step asked);
    /// What add() would say.
    Effect effect_of(Step asked) const noexcept;

    std::span<const Step> steps() const noexcept { return steps_; }  ///< Rising.

  private:
    std::int64_t between_;
    std::vector<Step> steps_;
};

/// What a cell shows whose parameters change from `from` to `to` at step `at`.
std::int32_t frame_at(const TimeLine& line, const Cycle& from, const Cycle& to, Step at, Step step) noexcept;

/// Whether a cell shows its first frame in all of `steps`; no, if that takes long to tell.
bool rests_through(const TimeLine& line, const Cycle& cycle, const Validity& steps) noexcept;
/// The same of one whose parameters change from `from` to `to` at step `at`: the steps begin there or later.
bool rests_through(const TimeLine& line, const Cycle& from, const Cycle& to, Step at,
                   const Validity& steps) noexcept;

/// What a cell shows that changes several times. `changes`: rising, as ChangeTimes says them; `cycles`: the
/// cell's before the first change, and after each. The validity goes from where the frame changed last to
/// where it changes next, across changes.
std::int32_t frame_at(const TimeLine& line, std::span<const Cycle> cycles, std::span<const Step> changes,
                      Step step) noexcept;
Shown shown_at(const TimeLine& line, std::span<const Cycle> cycles, std::span<const Step> changes,
               Step step) noexcept;

/// Of some changes the one that decides at `step`: 0 is before the first, where cycles[0] holds; else cells
/// go from cycles[i − 1] to cycles[i] at changes[i − 1].
std::size_t change_at(std::span<const Step> changes, Step step) noexcept;

}  // namespace tessera
