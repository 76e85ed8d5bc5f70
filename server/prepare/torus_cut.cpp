#include "server/prepare/torus_cut.h"

#include "server/prepare/graph_cut.h"

namespace tessera {
namespace {

/// What a border between s and t costs: how much the two images differ on both sides of it (Kwatra et al.,
/// "Graphcut textures", ACM TOG 22(3), 2003, equation 1).
std::uint32_t border_price(const PerceptualColor& first_s, const PerceptualColor& first_t,
                           const PerceptualColor& second_s, const PerceptualColor& second_t) {
    return color_distance(first_s, second_s) + color_distance(first_t, second_t);
}

/// The borders of a grid over which lie two images: `first(x, y)`, `second(x, y)`.
template <class First, class Second>
CutGrid make_grid(std::int32_t width, std::int32_t height, const First& first, const Second& second) {
    CutGrid grid{width, height};
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x) {
            const std::size_t i = grid.index(x, y);
            if (x + 1 < width)
                grid.right[i] = border_price(first(x, y), first(x + 1, y), second(x, y), second(x + 1, y));
            if (y + 1 < height)
                grid.below[i] = border_price(first(x, y), first(x, y + 1), second(x, y), second(x, y + 1));
        }
    return grid;
}

}  // namespace

PeriodicTile cut_on_torus(const PerceptualImage& photo, PhotoPoint place, std::int32_t side,
                          std::int32_t overlap, std::int32_t pinned) {
    // The left columns: what lies right of the tile is inside, from the first column on
    const auto at = [&](std::int32_t x, std::int32_t y) -> const PerceptualColor& {
        return photo.at(place.x + x, place.y + y);
    };
    CutGrid across =
        make_grid(overlap, side + overlap, at,
                  [&](std::int32_t x, std::int32_t y) -> const PerceptualColor& { return at(x + side, y); });
    for (std::int32_t y = 0; y < across.height; ++y) {
        across.outside[across.index(0, y)] = CutGrid::must;
        across.inside[across.index(overlap - 1, y)] = CutGrid::must;
    }
    const ShapeCut first_cut = cheapest_shape(across);
    const BitMask& left = first_cut.shape;

    // The upper rows, of that, what lies below is inside; the first column is there twice, divided the same
    // way
    const auto column = [&](std::int32_t x, std::int32_t y) {
        return x < overlap && left.at(x, y) ? x + side : x;
    };
    const auto joined = [&](std::int32_t x, std::int32_t y) -> const PerceptualColor& {
        return at(column(x % side, y), y);
    };
    CutGrid down = make_grid(
        side + 1, overlap, joined,
        [&](std::int32_t x, std::int32_t y) -> const PerceptualColor& { return joined(x, y + side); });
    const auto force = [&](std::int32_t x, std::int32_t y, bool inside) {
        (inside ? down.outside : down.inside)[down.index(x, y)] = CutGrid::must;
    };
    for (std::int32_t x = 1; x < side; ++x) {
        force(x, 0, true);
        force(x, overlap - 1, false);
    }
    for (std::int32_t y = 0; y < overlap; ++y) {
        force(0, y, y < pinned);
        force(side, y, y < pinned);
    }
    const ShapeCut second_cut = cheapest_shape(down);
    const BitMask& top = second_cut.shape;

    PeriodicTile tile{side, overlap, {}, first_cut.cost + second_cut.cost};
    tile.sources.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::int32_t row = y < overlap && top.at(x, y) ? y + side : y;
            tile.sources.push_back({place.x + column(x, row), place.y + row});
        }
    return tile;
}

}  // namespace tessera
