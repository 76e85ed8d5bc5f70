#pragma once

#include <cstdint>

#include "shared/motion/time_line.h"
#include "shared/motion/validity.h"

namespace tessera {

/// Rest for ever: a·Z = ∞. A cell that rests so long shows its first frame, always.
inline constexpr std::int64_t endless_rest = std::int64_t{1} << 62;

/// What one cell's animation depends on: φ, and a·Z.
struct Cycle {
    std::int64_t phase = 0;  ///< Any.
    std::int64_t rest = 0;   ///< From 0 to endless_rest.
    bool operator==(const Cycle&) const = default;
};

/// Densities are in steps of 2^-16; this one, and all above, is ∞.
inline constexpr std::uint64_t endless_density = std::uint64_t{1} << 47;

/// ⌊a·Z⌋, at most endless_rest. `rest`: Z, at least 0; of ∞ · 0 it is 0. `density`: a.
std::int64_t rest_of(std::int64_t rest, std::uint64_t density) noexcept;

/// The paper's p = max(0, (t + φ) mod (n + aZ) − aZ), in positions of the time line. Any step, any phase: no
/// sum is formed that does not fit.
std::int64_t position_at(const TimeLine& line, const Cycle& cycle, Step step) noexcept;

/// What a cell shows, and how long it does.
struct Shown {
    std::int32_t frame = 0;
    Validity validity{};
};
Shown shown_at(const TimeLine& line, const Cycle& cycle, Step step) noexcept;

/// The frame of an explicit parameter instead of the clock: `parameter` 65536ths of the time line without its
/// rest, clamped to 0 to 65535.
std::int32_t frame_of_parameter(const TimeLine& line, std::int64_t parameter) noexcept;

}  // namespace tessera
