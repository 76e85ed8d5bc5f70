#pragma once

#include <cstdint>
#include <vector>

#include "shared/page/texel_image.h"

namespace tessera::painting {

/// One of some tiles of asphalt; they all meet.
inline constexpr std::int32_t asphalt_tiles = 8;
Rgba8Image paint_asphalt(std::int32_t number, std::int32_t side);

/// Where a road winds through a meadow: 0 meadow, 1 asphalt, 2 paint on it. `side`² codes, whose borders
/// meet; about the left and right border the road's middle is the first row.
std::vector<std::uint8_t> paint_road_map(std::int32_t side);

/// What is put on a road by hand, on nothing: footprints that walk upwards, plates, a lamp.
enum class RoadThing : std::uint8_t { left_foot, right_foot, no_entry, warning, arrow, lamp_out, lamp_lit };
inline constexpr std::int32_t road_things = 7;
Rgba8Image paint_road_thing(RoadThing thing, std::int32_t side);

}  // namespace tessera::painting
