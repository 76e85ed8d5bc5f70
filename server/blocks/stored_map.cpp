#include "server/blocks/stored_map.h"

namespace tessera {

std::vector<std::int32_t> possible_values(const StoredMap& map) {
    std::vector<std::int32_t> values = map.values.distinct();
    for (std::int32_t value = map.least; value <= map.most; ++value) values.push_back(value);
    if (map.edge == StoredMap::Edge::blank) values.push_back(-1);
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

}  // namespace tessera
