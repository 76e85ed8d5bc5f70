#include "server/blocks/stored_map.h"

namespace tessera {

std::vector<std::int32_t> possible_values(const StoredMap& map) {
    std::vector<std::int32_t> states;
    constexpr std::int64_t listed = std::int64_t{1} << 20;
    const auto [least, most] = std::minmax_element(map.values.begin(), map.values.end());
    if (!map.values.empty() && std::int64_t{*most} - *least < listed) {
        std::vector<bool> present(static_cast<std::size_t>(*most - *least + 1));
        for (const std::int32_t value : map.values) present[static_cast<std::size_t>(value - *least)] = true;
        for (std::size_t i = 0; i < present.size(); ++i)
            if (present[i]) states.push_back(*least + static_cast<std::int32_t>(i));
    } else {
        states.assign(map.values.begin(), map.values.end());
    }
    for (std::int32_t value = map.least; value <= map.most; ++value) states.push_back(value);
    if (map.edge == StoredMap::Edge::blank) states.push_back(-1);
    std::sort(states.begin(), states.end());
    states.erase(std::unique(states.begin(), states.end()), states.end());
    return states;
}

}  // namespace tessera
