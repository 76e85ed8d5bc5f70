#pragma once

#include <cstdint>

#include "shared/motion/cycle.h"

namespace tessera {

/// What is left of a + b modulo `cycle`, at least 0. No sum is formed that does not fit.
inline std::int64_t left_of_sum(std::int64_t a, std::int64_t b, std::int64_t cycle) noexcept {
    __extension__ using Wide = __int128;
    std::int64_t sum = 0;
    const auto left =
        !__builtin_add_overflow(a, b, &sum) ? sum % cycle : static_cast<std::int64_t>((Wide{a} + b) % cycle);
    return left < 0 ? left + cycle : left;
}

/// Where a cell is in a cycle whose rest is not endless: `at` steps from its beginning; up to and including
/// step `before` it rests.
struct CyclePlace {
    std::int64_t at = 0, before = 0;
};

inline CyclePlace place_at(const TimeLine& line, const Cycle& cycle, Step step) noexcept {
    const std::int64_t before = cycle.rest + line.lead();
    return {left_of_sum(step, cycle.phase, before + line.run()), before};
}

}  // namespace tessera
