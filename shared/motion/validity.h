#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace tessera {

/// Time is an integer: the animation clock, in steps. Any 64-bit integer is a step, except the two that mean
/// "always" and "never".
using Step = std::int64_t;

inline constexpr Step always = std::numeric_limits<Step>::min();  ///< Before every step.
inline constexpr Step never = std::numeric_limits<Step>::max();   ///< After every step.

/// The half-open interval of steps [from, until) in which something stays the same.
struct Validity {
    Step from = always;
    Step until = never;

    constexpr bool holds(Step step) const noexcept { return from <= step && step < until; }
    constexpr bool is_static() const noexcept { return from == always && until == never; }
    /// In which this and `other` stay the same.
    constexpr void meet(const Validity& other) noexcept {
        from = std::max(from, other.from);
        until = std::min(until, other.until);
    }
    bool operator==(const Validity&) const = default;
};

/// a + b, where it is no step any more "always" or "never".
constexpr Step add_steps(Step a, std::int64_t b) noexcept {
    Step sum = 0;
    if (__builtin_add_overflow(a, b, &sum)) return b < 0 ? always : never;
    return sum;
}

}  // namespace tessera
