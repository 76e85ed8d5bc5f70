#pragma once

#include <cstdint>

#include "shared/page/texel_image.h"

namespace tessera::painting {

/// A red light-emitting diode on its board, from out (0) to fully lit (1).
Rgba8Image paint_led(double lit, std::int32_t side);

/// A spark of light, from faint (0) to bright (1), on nothing.
Rgba8Image paint_glow(double lit, std::int32_t side);

}  // namespace tessera::painting
