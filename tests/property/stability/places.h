#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "shared/page/page_key.h"

namespace tessera::tests {

inline constexpr std::size_t places_count = 5;

/// A square of `level` where an evaluator might go wrong: at the origin, across it, across 2^38 (and its
/// half), in the middle of nowhere, and beyond ±2^38.
inline TexelRegion region_at(std::uint8_t level, std::size_t place, std::int32_t side) {
    const std::int64_t far = std::int64_t{1} << (38 - level);
    const std::array<std::array<std::int64_t, 2>, places_count> places{{
        {0, 0},
        {-13, -7},
        {far - 9, far / 2 - 11},
        {std::int64_t{1234567891} >> level, -(std::int64_t{76543210987} >> level)},
        {-far, far + 5},
    }};
    return {level, places[place][0], places[place][1], side, side - 3};
}

}  // namespace tessera::tests
