#include "server/pattern/map_states.h"

#include <algorithm>

namespace tessera {

std::optional<MapStates> MapStates::of(const StoredMap& map) {
    constexpr std::int64_t most_apart = std::int64_t{1} << 22;
    constexpr std::size_t most_states = std::size_t{1} << 16;
    const auto [least_at, most_at] = std::minmax_element(map.values.begin(), map.values.end());
    std::int64_t least = *least_at, most = *most_at;
    if (map.bounded()) {
        least = std::min<std::int64_t>(least, map.least);
        most = std::max<std::int64_t>(most, map.most);
    }
    if (map.edge == StoredMap::Edge::blank) {
        least = std::min<std::int64_t>(least, -1);
        most = std::max<std::int64_t>(most, -1);
    }
    if (most - least >= most_apart) return std::nullopt;

    std::vector<bool> present(static_cast<std::size_t>(most - least + 1));
    for (std::int64_t value = map.least; value <= map.most; ++value)
        present[static_cast<std::size_t>(value - least)] = true;
    for (const std::int32_t value : map.values) present[static_cast<std::size_t>(value - least)] = true;
    if (map.edge == StoredMap::Edge::blank) present[static_cast<std::size_t>(-1 - least)] = true;
    MapStates states;
    states.numbers_.resize(present.size());
    for (std::size_t i = 0; i < present.size(); ++i) {
        if (!present[i]) continue;
        if (states.values_.size() == most_states) return std::nullopt;
        states.numbers_[i] = static_cast<std::uint16_t>(states.values_.size());
        states.values_.push_back(static_cast<std::int32_t>(least + static_cast<std::int64_t>(i)));
    }
    return states;
}

}  // namespace tessera
