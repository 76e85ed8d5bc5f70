#pragma once

#include <cstdint>
#include <vector>

namespace tessera::painting {

/// Areas of `meadow-sand`: 0 meadow, 1 sand; rows from the top, borders meet.
std::vector<std::uint8_t> paint_shore_map(std::int32_t side);

/// Areas of `autumn`: 0 open lawn; under a 1 birch, 2 maple, 3 oak; 4 a drift. Borders meet.
std::vector<std::uint8_t> paint_leaf_map(std::int32_t side);

}  // namespace tessera::painting
