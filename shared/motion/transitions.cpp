#include "shared/motion/transitions.h"

#include <algorithm>

#include "shared/motion/cycle_place.h"

namespace tessera {

namespace {

/// From which step on a cell shows the new cycle, and up to which the old one; rest in between.
struct Passage {
    Step old_until, new_from;
};

Passage passage(const TimeLine& line, const Cycle& from, const Cycle& to, Step at) noexcept {
    const std::int64_t shown = position_at(line, from, at);
    const Step last = shown == 0 ? at : add_steps(at, line.run() - shown);  // The paper's t_f
    const std::int64_t collides = last == never ? 0 : position_at(line, to, last);
    const Step next = add_steps(last, 1);
    return {next, collides == 0 ? next : add_steps(last, line.run() - collides)};
}

std::int32_t frame_of(const TimeLine& line, const Cycle& cycle, Step step) noexcept {
    return line.frame_at(position_at(line, cycle, step));
}

/// Which cycle a cell follows, or that it rests for another's run to pass, and how long.
struct Piece {
    Cycle cycle;
    Validity holds;
};

Piece piece_at(const TimeLine& line, std::span<const Cycle> cycles, std::span<const Step> changes,
               Step step) noexcept {
    constexpr Cycle resting{0, endless_rest};
    const std::size_t change = change_at(changes, step);
    Piece piece{cycles[change], {}};
    if (change > 0) {
        const Passage passed = passage(line, cycles[change - 1], cycles[change], changes[change - 1]);
        if (step < passed.old_until) {
            piece = {cycles[change - 1], {always, passed.old_until}};
            if (change > 1)
                piece.holds.from =
                    passage(line, cycles[change - 2], cycles[change - 1], changes[change - 2]).new_from;
            return piece;
        }
        if (step < passed.new_from) return {resting, {passed.old_until, passed.new_from}};
        piece.holds.from = passed.new_from;
    }
    if (change < changes.size())
        piece.holds.until = passage(line, cycles[change], cycles[change + 1], changes[change]).old_until;
    return piece;
}

}  // namespace

ChangeTimes::Effect ChangeTimes::effect_of(Step asked) const noexcept {
    if (steps_.empty()) return {asked, false};
    // At the very step of a change cells still show what was before it
    const bool waiting = asked <= steps_.back();
    const std::size_t done = steps_.size() - (waiting ? 1 : 0);
    if (done == 0) return {asked, true};
    return {std::max(asked, add_steps(steps_[done - 1], between_)), waiting};
}

ChangeTimes::Effect ChangeTimes::add(Step asked) {
    const Effect effect = effect_of(asked);
    if (effect.replaces)
        steps_.back() = effect.step;
    else
        steps_.push_back(effect.step);
    return effect;
}

std::size_t change_at(std::span<const Step> changes, Step step) noexcept {
    return static_cast<std::size_t>(std::upper_bound(changes.begin(), changes.end(), step) - changes.begin());
}

std::int32_t frame_at(const TimeLine& line, const Cycle& from, const Cycle& to, Step at, Step step) noexcept {
    if (step <= at) return frame_of(line, from, step);
    const Passage passed = passage(line, from, to, at);
    if (step < passed.old_until) return frame_of(line, from, step);
    return step < passed.new_from ? 0 : frame_of(line, to, step);
}

bool rests_through(const TimeLine& line, const Cycle& cycle, const Validity& steps) noexcept {
    if (cycle.rest >= endless_rest) return true;
    const auto [at, before] = place_at(line, cycle, steps.from);
    return at <= before && add_steps(steps.from, before + 1 - at) >= steps.until;
}

bool rests_through(const TimeLine& line, const Cycle& from, const Cycle& to, Step at,
                   const Validity& steps) noexcept {
    // Nearly always: the old cycle is over after a run, at the latest, and the new one has not begun to run
    if (steps.from > add_steps(at, line.run()) && rests_through(line, to, {at, steps.until})) return true;
    const Passage passed = passage(line, from, to, at);
    // Unless it rests at the change, the old cycle runs on
    if (steps.from < passed.old_until && passed.old_until != add_steps(at, 1)) return false;
    const Step begin = std::max(steps.from, passed.new_from);
    return begin >= steps.until || rests_through(line, to, {begin, steps.until});
}

std::int32_t frame_at(const TimeLine& line, std::span<const Cycle> cycles, std::span<const Step> changes,
                      Step step) noexcept {
    const std::size_t change = change_at(changes, step);
    if (change == 0) return frame_of(line, cycles[0], step);
    return frame_at(line, cycles[change - 1], cycles[change], changes[change - 1], step);
}

Shown shown_at(const TimeLine& line, std::span<const Cycle> cycles, std::span<const Step> changes,
               Step step) noexcept {
    if (line.frames() == 1) return {};
    const Piece here = piece_at(line, cycles, changes, step);
    const Shown is = shown_at(line, here.cycle, step);
    Shown all = is;
    // On through the pieces, as long as they begin with the frame that the last ended with
    for (Step until = here.holds.until; all.validity.until >= until;) {
        all.validity.until = until;
        if (until == never) break;
        const Piece piece = piece_at(line, cycles, changes, until);
        const Shown next = shown_at(line, piece.cycle, until);
        if (next.frame != is.frame) break;
        all.validity.until = next.validity.until;
        until = piece.holds.until;
    }
    for (Step from = here.holds.from; all.validity.from <= from;) {
        all.validity.from = from;
        if (from == always) break;
        const Piece piece = piece_at(line, cycles, changes, from - 1);
        const Shown last = shown_at(line, piece.cycle, from - 1);
        if (last.frame != is.frame) break;
        all.validity.from = last.validity.from;
        from = piece.holds.from;
    }
    return all;
}

}  // namespace tessera
