#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace tessera {

// What the planner computes most. Of a machine without instructions of its own for these, the library's are
// calls.

/// Rounded down; beyond ±10^10, that.
inline std::int64_t floor_of(double value) {
    constexpr double far = 1e10;
    const double near = std::clamp(value, -far, far);
    const auto cut = static_cast<std::int64_t>(near);
    return cut - (static_cast<double>(cut) > near ? 1 : 0);
}

/// floor(log2(value)), for what is positive and no tiny number.
inline int floor_log2(double value) {
    return static_cast<int>(std::bit_cast<std::uint64_t>(value) >> 52) - 1023;
}

/// 2^level, for −1022 < level < 1024.
inline double power_of_two(int level) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(level + 1023) << 52);
}

}  // namespace tessera
