#pragma once

// When a target that walks straight comes into and leaves a distance to a place.

#include <cmath>
#include <cstdint>

#include "shared/motion/targets.h"

namespace tessera {

/// The step, 0 to walk.steps, at which a walk is closest to a cell: of those before it the distance falls, of
/// those after it rises.
inline std::int64_t closest_on(const MovingTarget::Walk& walk, MotionPoint cell) noexcept {
    __extension__ using Wide = __int128;
    const Wide length = Wide{walk.by.x} * walk.by.x + Wide{walk.by.y} * walk.by.y;
    if (length == 0) return 0;
    const Wide along = Wide{cell.x - walk.from.x} * walk.by.x + Wide{cell.y - walk.from.y} * walk.by.y;
    if (along <= 0) return 0;
    if (along >= length) return walk.steps;
    // The nearest step to along / length · steps
    return static_cast<std::int64_t>((2 * along * walk.steps + length) / (2 * length));
}

/// The least of (from, to] for which `is` holds, which then holds for all after it; to + 1 if there is none.
/// It is found at once where it is `guess`, or beside it.
template <class Is>
std::int64_t first_of(std::int64_t from, std::int64_t to, std::int64_t guess, const Is& is) {
    if (from >= to || !is(to)) return to + 1;
    for (const std::int64_t near : {guess, guess - 1, guess + 1})
        if (near > from && near < to) (is(near) ? to : from) = near;
    while (to - from > 1) {
        const std::int64_t middle = from + (to - from) / 2;
        (is(middle) ? to : from) = middle;
    }
    return to;
}

/// The largest of [from, to) for which `is` holds, which then holds for all before it; from − 1 if there is
/// none.
template <class Is>
std::int64_t last_of(std::int64_t from, std::int64_t to, std::int64_t guess, const Is& is) {
    if (from >= to || !is(from)) return from - 1;
    for (const std::int64_t near : {guess, guess + 1, guess - 1})
        if (near > from && near < to) (is(near) ? from : to) = near;
    while (to - from > 1) {
        const std::int64_t middle = from + (to - from) / 2;
        (is(middle) ? from : to) = middle;
    }
    return from;
}

/// About how many steps before and after it is closest a walk comes into and leaves a distance.
inline double steps_within(const MovingTarget::Walk& walk, MotionPoint cell, std::int64_t reach) noexcept {
    const double bx = static_cast<double>(walk.by.x), by = static_cast<double>(walk.by.y);
    const double px = static_cast<double>(cell.x - walk.from.x),
                 py = static_cast<double>(cell.y - walk.from.y);
    const double length = bx * bx + by * by, aside = px * by - py * bx, radius = static_cast<double>(reach);
    const double square = radius * radius * length - aside * aside;
    if (length <= 0 || square <= 0) return 0;
    return std::sqrt(square) / length * static_cast<double>(walk.steps);
}

}  // namespace tessera
