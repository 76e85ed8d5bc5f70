#pragma once

#include <pugixml.hpp>

#include "server/tiled/tiled_map.h"
#include "server/tiled/xml_file.h"

namespace tessera {

/// Reads a <tileset> of `numbers.file()` into `map`: its images, tiles, probabilities, animations and Wang
/// sets. `first`: the number of its first tile.
Result<void> read_tileset(const pugi::xml_node& element, std::uint32_t first, XmlNumbers& numbers,
                          TiledMap& map);

}  // namespace tessera
