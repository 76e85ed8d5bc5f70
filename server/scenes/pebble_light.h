#pragma once

#include <cstdint>

#include "server/scenes/pebble_pile.h"

namespace tessera {

/// Unit vector towards the sun: x rightwards, y downwards, z out of the picture. From the upper left, as
/// people expect of a relief.
inline constexpr double sun_x = -0.5241, sun_y = -0.4717, sun_z = 0.7092;

/// How much of the sun's disc a texel sees past the stones around it, 0 to 1: 1 in the open.
double sunlight(const PebblePile& pile, std::int32_t x, std::int32_t y) noexcept;

/// How much of the sky a texel sees past the stones around it, 0 to 1.
double skylight(const PebblePile& pile, std::int32_t x, std::int32_t y) noexcept;

}  // namespace tessera
