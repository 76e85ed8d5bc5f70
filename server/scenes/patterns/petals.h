#pragma once

#include <cstdint>

#include "shared/page/texel_image.h"

namespace tessera::painting {

/// What falls from a cherry tree: petals, and then whole blossoms.
inline constexpr std::int32_t single_petals = 4, petal_patterns = 6;
Rgba8Image paint_petal(std::int32_t number, std::int32_t side);

}  // namespace tessera::painting
