#include "client/render/held_map.h"

#include <algorithm>
#include <cmath>

namespace tessera {

HeldMap HeldMap::of(std::span<const HeldReach> sprites) {
    HeldMap map;
    if (sprites.empty()) return map;
    double right = -INFINITY, bottom = -INFINITY;
    map.low_x = map.low_y = INFINITY;
    for (const HeldReach& sprite : sprites) {
        map.cell = std::max(map.cell, 2 * sprite.radius);
        map.low_x = std::min(map.low_x, sprite.x - sprite.radius);
        map.low_y = std::min(map.low_y, sprite.y - sprite.radius);
        right = std::max(right, sprite.x + sprite.radius);
        bottom = std::max(bottom, sprite.y + sprite.radius);
    }
    map.cell = std::max(map.cell, std::max(right - map.low_x, bottom - map.low_y) / (most_side - 1));
    map.columns = static_cast<int>((right - map.low_x) / map.cell) + 1;
    map.rows = static_cast<int>((bottom - map.low_y) / map.cell) + 1;
    const auto area = static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows);
    std::vector<std::uint8_t> used(area);
    for (std::size_t i = 0; i < sprites.size(); ++i) {
        const HeldReach& sprite = sprites[i];
        const auto first = [&](double at, double low) {
            return static_cast<int>((at - sprite.radius - low) / map.cell);
        };
        const auto last = [&](double at, double low, int count) {
            return std::min(static_cast<int>((at + sprite.radius - low) / map.cell), count - 1);
        };
        bool is_whole = true;
        for (int y = first(sprite.y, map.low_y); y <= last(sprite.y, map.low_y, map.rows); ++y)
            for (int x = first(sprite.x, map.low_x); x <= last(sprite.x, map.low_x, map.columns); ++x) {
                const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(map.columns) +
                                static_cast<std::size_t>(x);
                if (used[at] == most_layers) {
                    is_whole = false;
                    continue;
                }
                const std::size_t layer = used[at]++;
                if (map.cells.size() < (layer + 1) * area) map.cells.resize((layer + 1) * area);
                map.cells[layer * area + at] = static_cast<std::uint16_t>(i + 1);
                map.layers = std::max(map.layers, static_cast<int>(layer) + 1);
            }
        if (!is_whole) ++map.hidden;
    }
    return map;
}

}  // namespace tessera
