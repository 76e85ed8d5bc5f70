#include "shared/motion/targets.h"

#include <algorithm>
#include <cmath>

#include "shared/motion/walk_times.h"

namespace tessera {

namespace {

__extension__ using Wide = __int128;

constexpr Wide floor_divided(Wide a, Wide b) noexcept { return a / b - (a % b < 0 ? 1 : 0); }

}  // namespace

MovingTarget::MovingTarget(std::span<const Leg> legs, Step first)
    : legs_(legs.begin(), legs.end()), first_{first} {
    std::int64_t begin = 0;
    for (const Leg& leg : legs) {
        begins_.push_back(begin);
        begin += leg.steps;
    }
    begins_.push_back(begin);
    box_ = {legs_.front().from, legs_.front().from};
    for (const Leg& leg : legs_) {
        box_.least = {std::min(box_.least.x, leg.from.x), std::min(box_.least.y, leg.from.y)};
        box_.most = {std::max(box_.most.x, leg.from.x), std::max(box_.most.y, leg.from.y)};
    }
    for (std::size_t i = 0; i < legs_.size(); ++i) {
        const MotionPoint from = legs_[i].from, to = legs_[(i + 1) % legs_.size()].from;
        speed_ = std::max(speed_,
                          std::hypot(static_cast<double>(to.x - from.x), static_cast<double>(to.y - from.y)) /
                              legs_[i].steps);
    }
}

bool MovingTarget::moves() const noexcept {
    return box_.least.x != box_.most.x || box_.least.y != box_.most.y;
}

MovingTarget::Box MovingTarget::box(Step from, Step until) const noexcept {
    if (Wide{until} - from >= round_steps()) return box_;
    const auto corner = [](const Place& place, bool up) {
        return MotionPoint{place.x + (up && place.x_rest > 0), place.y + (up && place.y_rest > 0)};
    };
    const Place first = at(from);
    Box box{corner(first, false), corner(first, true)};
    const auto add = [&box](MotionPoint least, MotionPoint most) {
        box.least = {std::min(box.least.x, least.x), std::min(box.least.y, least.y)};
        box.most = {std::max(box.most.x, most.x), std::max(box.most.y, most.y)};
    };
    // Each leg's end on the way, and where it is at last
    for (Walk walk = walk_at(from);;) {
        const Step next = add_steps(walk.begin, walk.steps);
        if (next >= until) break;
        walk = walk_at(next);
        add(walk.from, walk.from);
    }
    const Place last = at(until - 1);
    add(corner(last, false), corner(last, true));
    return box;
}

MovingTarget::Walk MovingTarget::walk_at(Step step) const noexcept {
    std::int64_t since = 0;
    if (__builtin_sub_overflow(step, first_, &since))
        since = static_cast<std::int64_t>((Wide{step} - first_) % round_steps());
    else
        since %= round_steps();
    const std::int64_t at = since < 0 ? since + round_steps() : since;
    const auto leg =
        static_cast<std::size_t>(std::upper_bound(begins_.begin(), begins_.end() - 1, at) - begins_.begin()) -
        1;
    const MotionPoint from = legs_[leg].from, to = legs_[(leg + 1) % legs_.size()].from;
    return {add_steps(step, begins_[leg] - at), legs_[leg].steps, from, {to.x - from.x, to.y - from.y}};
}

MovingTarget::Place MovingTarget::at(Step step) const noexcept {
    const Walk walk = walk_at(step);
    const Wide moved = Wide{step} - walk.begin;
    const auto along = [&](std::int64_t from, std::int64_t by, std::int64_t& rest) {
        const Wide way = moved * by, whole = floor_divided(way, walk.steps);
        rest = static_cast<std::int64_t>(way - whole * walk.steps);
        return from + static_cast<std::int64_t>(whole);
    };
    Place place{.parts = walk.steps};
    place.x = along(walk.from.x, walk.by.x, place.x_rest);
    place.y = along(walk.from.y, walk.by.y, place.y_rest);
    return place;
}

TargetDistance::TargetDistance(const TimeLine& line, std::int64_t near, std::int64_t far,
                               std::span<const MovingTarget> targets)
    : TargetDistance{line, near, far,
                     std::make_shared<const std::vector<MovingTarget>>(targets.begin(), targets.end())} {}

TargetDistance::TargetDistance(const TimeLine& line, std::int64_t near, std::int64_t far,
                               std::shared_ptr<const std::vector<MovingTarget>> targets)
    : targets_{std::move(targets)} {
    for (const MovingTarget& target : *targets_) round_ = std::max(round_, target.round_steps());
    // The way from `far` to `near` in equal parts, one for each position
    for (std::int32_t frame = 1; frame < line.frames(); ++frame)
        reach_.push_back(far -
                         static_cast<std::int64_t>(Wide{far - near} * line.begin_of(frame) / line.run()));
}

namespace {

/// The ring of a distance whose parts along the axes are x / parts and y / parts: below it no ring is
/// reached.
template <class Integer>
std::int32_t ring_of(Integer x, Integer y, Integer parts, const std::vector<std::int64_t>& reaches) noexcept {
    const Integer square = x * x + y * y;
    const auto beyond = std::partition_point(reaches.begin(), reaches.end(), [&](std::int64_t reach) {
        const Integer scaled = static_cast<Integer>(reach) * parts;
        return square <= scaled * scaled;
    });
    return static_cast<std::int32_t>(beyond - reaches.begin());
}

}  // namespace

std::int32_t TargetDistance::frame_on(const MovingTarget::Walk& walk, MotionPoint cell,
                                      std::int64_t moved) const noexcept {
    if (reach_.empty()) return 0;
    // All lengths times walk.steps, so that nothing is rounded: below 2^28 · 2^28 where it is squared
    const Wide x = Wide{walk.from.x - cell.x} * walk.steps + Wide{walk.by.x} * moved;
    const Wide y = Wide{walk.from.y - cell.y} * walk.steps + Wide{walk.by.y} * moved;
    const Wide most = Wide{reach_.front()} * walk.steps;
    if (x > most || x < -most || y > most || y < -most) return 0;
    constexpr Wide small = Wide{1} << 31;
    if (most < small)
        return ring_of(static_cast<std::int64_t>(x), static_cast<std::int64_t>(y), walk.steps, reach_);
    return ring_of<Wide>(x, y, walk.steps, reach_);
}

Step TargetDistance::next_change(const MovingTarget& target, MotionPoint cell, Step step,
                                 Step limit) const noexcept {
    if (!ever_near(target, cell)) return never;
    MovingTarget::Walk walk = target.walk_at(step);
    std::int64_t moved = step - walk.begin;
    const std::int32_t frame = frame_on(walk, cell, moved);
    const auto ring = static_cast<std::size_t>(frame);
    const auto differs = [&](std::int64_t at) { return frame_on(walk, cell, at) != frame; };
    const Step round_over = std::min(add_steps(step, target.round_steps()), limit);
    for (;;) {
        // It comes nearer, into the next ring; then it goes, out of this one
        const std::int64_t closest = closest_on(walk, cell);
        if (ring < reach_.size() && moved < closest) {
            const double within = steps_within(walk, cell, reach_[ring]);
            const std::int64_t change =
                first_of(moved, closest, closest - static_cast<std::int64_t>(within), differs);
            if (change <= closest) return add_steps(walk.begin, change);
        }
        if (ring > 0) {
            const double within = steps_within(walk, cell, reach_[ring - 1]);
            const std::int64_t change = first_of(std::max(moved, closest), walk.steps,
                                                 closest + static_cast<std::int64_t>(within) + 1, differs);
            if (change <= walk.steps) return add_steps(walk.begin, change);
        }
        const Step next = add_steps(walk.begin, walk.steps);
        if (next >= round_over) return never;
        walk = target.walk_at(next);
        moved = 0;
    }
}

Step TargetDistance::last_change(const MovingTarget& target, MotionPoint cell, Step step,
                                 Step limit) const noexcept {
    if (!ever_near(target, cell)) return always;
    MovingTarget::Walk walk = target.walk_at(step);
    std::int64_t moved = step - walk.begin;
    const std::int32_t frame = frame_on(walk, cell, moved);
    const auto ring = static_cast<std::size_t>(frame);
    const auto differs = [&](std::int64_t at) { return frame_on(walk, cell, at) != frame; };
    const Step round_over = std::max(add_steps(step, -target.round_steps()), limit);
    for (;;) {
        // The same backwards
        const std::int64_t closest = closest_on(walk, cell);
        if (ring < reach_.size() && moved > closest) {
            const double within = steps_within(walk, cell, reach_[ring]);
            const std::int64_t change =
                last_of(closest, moved, closest + static_cast<std::int64_t>(within), differs);
            if (change >= closest) return add_steps(walk.begin, change + 1);
        }
        if (ring > 0) {
            const double within = steps_within(walk, cell, reach_[ring - 1]);
            const std::int64_t change = last_of(0, std::min(moved, closest),
                                                closest - static_cast<std::int64_t>(within) - 1, differs);
            if (change >= 0) return add_steps(walk.begin, change + 1);
        }
        if (walk.begin <= round_over) return always;
        walk = target.walk_at(walk.begin - 1);
        moved = walk.steps;
    }
}

std::int32_t TargetDistance::frame_at(MotionPoint cell, Step step) const noexcept {
    std::int32_t frame = 0;
    for (const MovingTarget& target : *targets_) {
        if (!ever_near(target, cell)) continue;
        const MovingTarget::Walk walk = target.walk_at(step);
        frame = std::max(frame, frame_on(walk, cell, step - walk.begin));
    }
    return frame;
}

TargetDistance::Answer TargetDistance::shown_at(MotionPoint cell, Step step,
                                                const Validity& within) const noexcept {
    const std::int32_t frame = frame_at(cell, step);
    if (reach_.empty() || targets_->empty()) return {frame, {}};
    // Targets change by turns, and what is nearest may do so without the frame
    const Step round_over = add_steps(step, round_), round_before = add_steps(step, -round_);
    const Step latest = std::min(round_over, within.until), earliest = std::max(round_before, within.from);
    Validity validity{step, step};
    do {
        Step next = never;
        for (const MovingTarget& target : *targets_)
            next = std::min(next, next_change(target, cell, validity.until, latest));
        validity.until = next;
    } while (validity.until < latest && frame_at(cell, validity.until) == frame);
    if (validity.until >= latest) {
        if (latest == round_over) return {frame, {}};  // Not once in a whole round
        validity.until = never;
    }
    for (Step at = step;; at = validity.from - 1) {
        Step last = always;
        for (const MovingTarget& target : *targets_)
            last = std::max(last, last_change(target, cell, at, earliest));
        validity.from = last;
        if (validity.from <= earliest || frame_at(cell, validity.from - 1) != frame) break;
    }
    if (validity.from <= earliest && earliest > round_before) validity.from = always;
    return {frame, validity};
}

}  // namespace tessera
