#pragma once

#include <cstdint>

#include "shared/page/texel_image.h"

namespace tessera::painting {

inline constexpr std::int32_t forest_floor_tiles = 8, lawn_tiles = 8, leaf_patterns = 8;

/// Soil with moss, needles, twigs and crumbs; all its tiles meet.
Rgba8Image paint_forest_floor(std::int32_t number, std::int32_t side);
/// Short grass with little else; all its tiles meet.
Rgba8Image paint_lawn(std::int32_t number, std::int32_t side);
/// Leaves of autumn, one of each kind or colour.
Rgba8Image paint_autumn_leaf(std::int32_t number, std::int32_t side);

}  // namespace tessera::painting
