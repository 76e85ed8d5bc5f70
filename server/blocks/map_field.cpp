#include "server/blocks/map_field.h"

#include <algorithm>
#include <bit>
#include <tuple>

namespace tessera {

int power_of_two(std::uint32_t value, std::uint32_t unset, int most_log2) noexcept {
    if (value == 0) value = unset;
    if (!std::has_single_bit(value)) return -1;
    const int log2 = std::countr_zero(value);
    return log2 <= most_log2 ? log2 : -1;
}

Result<void> check_map_size(Compilation& c, std::size_t block, std::string_view field, const StoredMap& map) {
    const std::int64_t entries = std::int64_t{map.width} * map.height;
    if (map.width < 1 || map.height < 1 || map.width > max_map_side || map.height > max_map_side ||
        entries > max_map_entries || map.values.size() != static_cast<std::size_t>(entries))
        return c.error(block, field,
                       "is a map of " + std::to_string(map.width) + " × " + std::to_string(map.height) +
                           " entries; its sides are from 1 to 32768, and it has at most 2^26 entries");
    return {};
}

std::pair<std::int32_t, std::int32_t> map_range(const StoredMap& map) {
    std::int32_t least = map.values.distinct().front(), most = map.values.distinct().back();
    if (map.bounded()) least = std::min(least, map.least), most = std::max(most, map.most);
    return {map.edge == StoredMap::Edge::blank ? std::min(least, -1) : least, most};
}

Result<StoredMap> map_of_values(Compilation& c, std::size_t block, std::string_view field,
                                const google::protobuf::RepeatedField<std::int32_t>& values,
                                std::uint32_t width) {
    const auto wrong = [&](std::string_view name, std::string_view what) {
        return c.error(block, std::string{field} + std::string{name}, what);
    };
    const auto count = static_cast<std::uint32_t>(values.size());
    if (width == 0) return wrong(".width", "is 0; the number of entries in a row of values");
    if (count % width != 0)
        return wrong(".values", "has " + std::to_string(count) + " entries, no whole rows of width " +
                                    std::to_string(width) + "; add or remove some");
    StoredMap map;
    map.width = static_cast<std::int32_t>(std::min<std::uint32_t>(width, 0x7fffffff));
    map.height = static_cast<std::int32_t>(count / width);
    map.values = std::vector<std::int32_t>(values.begin(), values.end());
    if (auto size = check_map_size(c, block, std::string{field} + ".values", map); !size) return size.error();
    const bool all_known = map.values.distinct().front() >= -1;
    for (std::size_t i = 0; i < map.values.size() && !all_known; ++i)
        if (map.values[i] < -1)
            return wrong(".values[" + std::to_string(i) + "]",
                         "is " + std::to_string(map.values[i]) + "; from 0 on, or -1 for blank");
    return map;
}

Result<std::shared_ptr<const StoredMap>> read_explicit_map(Compilation& c, std::size_t block,
                                                           std::string_view field,
                                                           const proto::ExplicitMap& message) {
    const auto wrong = [&](std::string_view name, std::string_view what) {
        return c.error(block, std::string{field} + std::string{name}, what);
    };
    const proto::Block& its_block = *c.graph.blocks[block].message;
    const int cells_log2 = power_of_two(message.cells(), 1, 16);
    if (cells_log2 < 0)
        return wrong(".cells", "is " + std::to_string(message.cells()) + "; a power of two from 1 to 65536");
    const std::int64_t cells = std::int64_t{1} << cells_log2;
    const auto check_place = [&](std::string_view name, std::int64_t value) -> Result<void> {
        if (value % cells != 0)
            return wrong(name,
                         "is " + std::to_string(value) + "; a multiple of cells, " + std::to_string(cells));
        if (value <= -max_map_cell || value >= max_map_cell)
            return wrong(name, "is " + std::to_string(value) + "; less than 2^40 cells from the origin");
        return {};
    };
    if (auto x = check_place(".x", message.x()); !x) return x.error();
    if (auto y = check_place(".y", message.y()); !y) return y.error();
    if (message.image().empty() == message.values().empty() && c.files.painted(its_block.name()) == nullptr)
        return wrong("", message.image().empty() ? "has neither image nor values; give one of them"
                                                 : "has both image and values; give one of them");

    StoredMap map;
    if (const StoredMap* painted = c.files.painted(its_block.name())) {
        map = *painted;
    } else if (!message.image().empty()) {
        if (message.width() != 0)
            return wrong(".width", "is " + std::to_string(message.width()) +
                                       ", but the map is an image, which "
                                       "has a width of its own; leave it out");
        const std::string path = c.graph.blocks[block].path + std::string{field} + ".image";
        auto read = c.files.read_map(path, message.image());
        if (!read) return read.error();
        map = std::move(*read);
        if (auto size = check_map_size(c, block, std::string{field} + ".image", map); !size)
            return size.error();
        if (message.has_blank_code() && message.blank_code() > 65535)
            return wrong(".blank_code",
                         "is " + std::to_string(message.blank_code()) + "; a code up to 65535");
        if (message.has_blank_code())
            for (std::size_t i = 0; i < map.values.size(); ++i)
                if (map.values[i] == static_cast<std::int32_t>(message.blank_code())) map.values.set(i, -1);
    } else {
        if (message.has_blank_code()) return wrong(".blank_code", "is for images; in values, -1 is blank");
        auto read = map_of_values(c, block, field, message.values(), message.width());
        if (!read) return read.error();
        map = std::move(*read);
    }
    switch (message.edge()) {
        case proto::ExplicitMap::wrap:
            map.edge = StoredMap::Edge::wrap;
            break;
        case proto::ExplicitMap::clamp:
            map.edge = StoredMap::Edge::clamp;
            break;
        case proto::ExplicitMap::blank:
            map.edge = StoredMap::Edge::blank;
            break;
        default:
            return wrong(".edge", "is " + std::to_string(message.edge()) + "; wrap, clamp or blank");
    }
    map.cells_log2 = cells_log2;
    map.x = message.x();
    map.y = message.y();
    if (is_editable(its_block, "map")) {
        if (const auto range = paintable_range(c, block)) std::tie(map.least, map.most) = *range;
        c.plan.maps.push_back({.block = its_block.name(), .map = map});
    }
    return std::make_shared<const StoredMap>(std::move(map));
}

}  // namespace tessera
