// Pixel Map (3.3): masks "to delimit precisely the shape of the areas corresponding to a material family".
#include "server/blocks/compilation.h"
#include "server/blocks/map_field.h"

namespace tessera {

namespace {

Result<StoredMap> read_pixels(Compilation& c, std::size_t block, const proto::PixelMap& message) {
    if (const StoredMap* painted = c.files.painted(c.graph.blocks[block].message->name())) return *painted;
    if (!message.image().empty() && !message.values().empty())
        return c.error(block, "", "has both image and values; give one of them");
    if (!message.values().empty()) {
        auto map = map_of_values(c, block, "", message.values(), message.width());
        if (!map) return map.error();
        return std::move(*map);
    }
    if (message.image().empty()) return c.error(block, ".image", "is missing; a file of one channel");
    auto map = c.files.read_map(c.graph.blocks[block].path + ".image", message.image());
    if (!map) return map.error();
    if (auto size = check_map_size(c, block, ".image", *map); !size) return size.error();
    return std::move(*map);
}

}  // namespace

Result<void> compile_pixel_map(Compilation& c, std::size_t block) {
    const proto::PixelMap& message = c.graph.blocks[block].message->pixel_map();
    if (message.textures().empty() || message.textures_size() > 255)
        return c.error(block, ".textures",
                       "lists " + std::to_string(message.textures_size()) + " textures; from 1 to 255");
    const int texels_log2 = power_of_two(message.texels(), 1, 12);
    if (texels_log2 < 0)
        return c.error(block, ".texels",
                       "is " + std::to_string(message.texels()) + "; a power of two from 1 to 4096");
    if (message.edge() != proto::ExplicitMap::wrap && message.edge() != proto::ExplicitMap::clamp)
        return c.error(block, ".edge", "is neither wrap nor clamp; what is outside needs a texture");
    auto textures = c.shown(block, message.textures());
    if (!textures) return textures.error();
    auto map = read_pixels(c, block, message);
    if (!map) return map.error();
    const std::vector<std::int32_t>& codes = map->values.distinct();
    const bool all_known = codes.front() >= 0 && codes.back() < message.textures_size();
    for (std::size_t i = 0; i < map->values.size() && !all_known; ++i) {
        if (map->values[i] >= 0 && map->values[i] < message.textures_size()) continue;
        const auto width = static_cast<std::size_t>(map->width);
        return c.error(block, message.values().empty() ? ".image" : ".values",
                       "holds the code " + std::to_string(map->values[i]) + " at (" +
                           std::to_string(i % width) + ", " + std::to_string(i / width) +
                           "), but textures has " + std::to_string(message.textures_size()) +
                           "; add textures, or repaint the map");
    }
    map->edge = message.edge() == proto::ExplicitMap::wrap ? StoredMap::Edge::wrap : StoredMap::Edge::clamp;
    map->cells_log2 = texels_log2;
    map->x = map->y = 0;
    if (is_editable(*c.graph.blocks[block].message, "map")) {
        map->least = 0;
        map->most = message.textures_size() - 1;
        c.plan.maps.push_back({.block = c.graph.blocks[block].message->name(), .map = *map, .shown = true});
    }
    c.notes[block] = std::to_string(map->width) + " × " + std::to_string(map->height) + " entries of " +
                     std::to_string(1 << texels_log2) + " texels";
    PixelMapPlan plan;
    plan.map = std::make_shared<const StoredMap>(std::move(*map));
    plan.textures = std::move(*textures);
    c.blocks[block].texture = c.plan.textures.size();
    c.plan.textures.push_back({c.graph.blocks[block].message->name(), std::move(plan)});
    return {};
}

}  // namespace tessera
