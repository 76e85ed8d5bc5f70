#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "server/tiled/tiled_map.h"
#include "server/tiled/xml_file.h"

namespace tessera {

/// The tiles at free places of an object layer, in the order in which they are drawn. What else it holds, and
/// what is hidden, is counted in `left_out`. A wrong attribute is in `numbers`.
ObjectLayer read_objects(const pugi::xml_node& group, XmlNumbers& numbers,
                         std::vector<std::string>& left_out);

}  // namespace tessera
