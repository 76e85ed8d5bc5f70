#pragma once

#include <cstdint>

#include "shared/page/texel_image.h"

namespace tessera::painting {

/// A flower from above, on nothing: from a bud (0) to wide open (1). Of each of the kinds.
inline constexpr std::int32_t flower_kinds = 3;
Rgba8Image paint_flower(std::int32_t kind, double open, std::int32_t side);

/// A ball that rolls over a field, with the darkness under it.
Rgba8Image paint_ball(std::int32_t kind, std::int32_t side);

}  // namespace tessera::painting
