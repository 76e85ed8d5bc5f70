#pragma once

#include <cstdint>
#include <vector>

#include "server/scenes/patterns/shore.h"

namespace tessera::painting {

/// Land from above: 0 sand, 1 forest, 2 rock, 3 snow.
inline constexpr std::int32_t land_families = 4, land_plain_tiles = 8;

/// A tile with a family at each corner; `variant` is of tiles of one family alone.
Rgba8Image paint_land_tile(const Corners& corners, std::int32_t variant, std::int32_t side);

/// Which family lies where, rows from the top: islands in a desert sea, forests, ranges, and snow on them.
/// Its borders meet.
std::vector<std::uint8_t> paint_land_map(std::int32_t side);

}  // namespace tessera::painting
