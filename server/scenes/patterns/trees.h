#pragma once

#include <cstdint>
#include <vector>

#include "shared/page/texel_image.h"

namespace tessera::painting {

/// Trees as stacks of slices, from the ground up: 0 has leaves, 1 needles.
inline constexpr std::int32_t tree_patterns = 2, tree_slices = 32;

/// All slices of one tree: sRGB codes, alpha straight. The first holds its shade on the ground too.
std::vector<Rgba8Image> paint_tree(std::int32_t number, std::int32_t side);

}  // namespace tessera::painting
