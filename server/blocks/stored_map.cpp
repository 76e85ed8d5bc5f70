#include "server/blocks/stored_map.h"

namespace tessera {

namespace {

std::vector<std::int32_t> look_up(const std::vector<std::int32_t>& values) {
    std::vector<std::int32_t> found;
    if (values.empty()) return found;
    constexpr std::int64_t listed = std::int64_t{1} << 20;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    if (std::int64_t{*most} - *least < listed) {
        std::vector<std::uint8_t> present(static_cast<std::size_t>(*most - *least + 1));
        for (const std::int32_t value : values) present[static_cast<std::size_t>(value - *least)] = 1;
        for (std::size_t i = 0; i < present.size(); ++i)
            if (present[i] != 0) found.push_back(*least + static_cast<std::int32_t>(i));
    } else {
        found = values;
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
    }
    return found;
}

}  // namespace

const std::vector<std::int32_t>& MapValues::distinct() const {
    static const std::vector<std::int32_t> none;
    if (!kept_) return none;
    std::call_once(kept_->looked_up, [this] { kept_->distinct = look_up(kept_->values); });
    return kept_->distinct;
}

std::vector<std::int32_t> possible_values(const StoredMap& map) {
    std::vector<std::int32_t> values = map.values.distinct();
    for (std::int32_t value = map.least; value <= map.most; ++value) values.push_back(value);
    if (map.edge == StoredMap::Edge::blank) values.push_back(-1);
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

}  // namespace tessera
