#include "server/quality/own_neighbours.h"

#include <algorithm>

#include "server/texture/unit_outline.h"

namespace tessera {
namespace {

const std::uint8_t* codes_at(const Rgb8Image& image, std::int64_t x, std::int64_t y) {
    if (x < 0 || y < 0 || x >= image.width || y >= image.height) return nullptr;
    return image.bytes.data() + static_cast<std::size_t>(y * image.width + x) * 3;
}

std::int64_t wrapped(std::int64_t value, std::int64_t period) { return (value % period + period) % period; }

}  // namespace

OwnNeighbours::OwnNeighbours(const ExchangeAsset& asset) : asset_{asset} {
    for (std::size_t patch = 0; patch < asset.patches.size(); ++patch)
        for (std::size_t content = 0; content < asset.patches[patch].contents.size(); ++content)
            if (asset.patches[patch].contents[content].standing != ExchangeAsset::Standing::dropped)
                shown_.push_back({patch, content});
}

const std::uint8_t* OwnNeighbours::beside(std::uint32_t source, std::int64_t x, std::int64_t y,
                                          std::int32_t dx, std::int32_t dy, const std::uint8_t* shown) const {
    const std::int64_t side = asset_.tile_side;
    // Tiles of wang end at their borders, the first of them too
    const bool tiles_end = asset_.method == ExchangeMethod::wang;
    const auto crosses = [&](std::int64_t at, std::int32_t step) {
        const std::int64_t to = wrapped(at, side) + step;
        return to < 0 || to >= side;
    };
    if (tiles_end && (crosses(x, dx) || crosses(y, dy))) return nullptr;
    if (source == 0) return codes_at(asset_.tile, wrapped(x + dx, side), wrapped(y + dy, side));
    if (source > shown_.size()) return nullptr;
    const auto& patch = asset_.patches[shown_[source - 1].patch];
    const auto& content = patch.contents[shown_[source - 1].content];
    const std::int64_t period = patch.group == 0 ? side : side * UnitOutline::tiles;
    for (std::int64_t v = wrapped(y - patch.y, period); v < patch.height; v += period)
        for (std::int64_t u = wrapped(x - patch.x, period); u < patch.width; u += period) {
            if (content.shape.width > 0 &&
                !content.shape.at(static_cast<std::int32_t>(u), static_cast<std::int32_t>(v)))
                continue;
            const std::uint8_t* here = codes_at(asset_.exemplar, content.at.x + u, content.at.y + v);
            if (here == nullptr || !std::equal(here, here + 3, shown)) continue;
            return codes_at(asset_.exemplar, content.at.x + u + dx, content.at.y + v + dy);
        }
    return nullptr;
}

}  // namespace tessera
