#pragma once

#include <array>
#include <cstdint>

#include "server/scenes/patterns/canvas.h"

namespace tessera::painting {

/// Families of the scene `meadow-sand`: 0 is meadow, 1 is sand. Which lies at a tile's corners: top-left,
/// top-right, bottom-left, bottom-right.
using Corners = std::array<std::int32_t, 4>;

/// How much of `family` there is at a place of a tile, from its corners alone: 0 to 1.
double corner_share(const Corners& corners, std::int32_t family, double x, double y, double side) noexcept;

inline constexpr std::int32_t sand_tiles = 16;

/// A tile of meadow, sand, or of both with an irregular border between them. `variant`: what grows or lies
/// there, and how the border runs inside the tile.
Rgba8Image paint_shore_tile(const Corners& corners, std::int32_t variant, std::int32_t side);

}  // namespace tessera::painting
