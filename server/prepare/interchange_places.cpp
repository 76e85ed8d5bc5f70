#include "server/prepare/interchange_places.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "server/prepare/interchange_patch.h"

namespace tessera {
namespace {

using Offset = ExchangeAsset::Offset;

struct Candidate {
    std::uint64_t cost = 0;
    Offset at;
    bool operator<(const Candidate& other) const {
        return std::tuple{cost, at.y, at.x} < std::tuple{other.cost, other.at.y, other.at.x};
    }
};

constexpr std::int32_t coarsest = 8;

/// Squares are compared at 8 to 16 texels a side, the smallest as they are.
std::int32_t factor_of(std::int32_t side) {
    std::int32_t factor = 1;
    while (factor < coarsest && side / factor > 16) factor *= 2;
    return factor;
}

bool lie_apart(const Offset& a, const Offset& b, std::int32_t distance) {
    return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y)) >= distance;
}

}  // namespace

PlaceSearch::PlaceSearch(const PerceptualImage& photo, const QuiltedTile& tile, std::int32_t margin)
    : photo_{photo}, tile_{tile}, margin_{margin} {
    for (std::int32_t factor = 1; factor <= coarsest; factor *= 2) {
        const PerceptualImage image = reduced(photo, factor);
        Reduced planes{image.width, image.height, {}, {}, {}};
        for (const PerceptualColor color : image.colors) {
            planes.lightness.push_back(color.lightness);
            planes.green_red.push_back(color.green_red);
            planes.blue_yellow.push_back(color.blue_yellow);
        }
        photos_[factor] = std::move(planes);
        tiles_[factor] = reduced(tile.colors, factor);
    }
}

PlaceSearch::Window PlaceSearch::everywhere(std::int32_t side) const {
    return {margin_, margin_, photo_.width - side - 2 * margin_ + 1, photo_.height - side - 2 * margin_ + 1};
}

std::vector<PlaceSearch::TileTexel> PlaceSearch::compared_texels(std::int32_t x, std::int32_t y,
                                                                 std::int32_t side,
                                                                 const std::vector<std::uint8_t>& compared,
                                                                 std::int32_t factor) const {
    const PerceptualImage& tile = tiles_.at(factor);
    const std::int32_t wrap = tile.width - 1, cells = side / factor;
    std::vector<TileTexel> texels;
    for (std::int32_t v = 0; v < cells; ++v)
        for (std::int32_t u = 0; u < cells; ++u) {
            std::int32_t marked = 0;
            for (std::int32_t t = 0; t < factor * factor; ++t) {
                const std::int32_t i = (v * factor + t / factor) * side + u * factor + t % factor;
                marked += compared[static_cast<std::size_t>(i)] != 0;
            }
            if (3 * marked < factor * factor) continue;
            texels.push_back({u, v, tile.at((x / factor + u) & wrap, (y / factor + v) & wrap)});
        }
    return texels;
}

bool PlaceSearch::shows_the_same(std::int32_t x, std::int32_t y, std::int32_t side, const Offset& at) const {
    const std::int32_t distance = std::max(4, side / 4);
    for (std::int32_t i = 0; i < 9; ++i) {
        const std::int32_t u = side * (1 + i % 3) / 4, v = side * (1 + i / 3) / 4;
        const PhotoPoint source = tile_.source(x + u, y + v);
        if (!lie_apart({source.x, source.y}, {at.x + u, at.y + v}, distance)) return true;
    }
    return false;
}

std::vector<Offset> PlaceSearch::best(std::int32_t x, std::int32_t y, std::int32_t side,
                                      const std::vector<std::uint8_t>& compared, const Band& band,
                                      std::size_t count) const {
    std::int32_t factor = factor_of(side);
    while (factor > std::max(1, band.rows)) factor /= 2;
    const Window window = everywhere(side);
    const Reduced& photo = photos_.at(factor);
    // On the grid of reduced texels, of the tile and of the photograph
    const std::int32_t skew_x = x & (factor - 1), skew_y = y & (factor - 1);
    const std::vector<TileTexel> coarse = compared_texels(x - skew_x, y - skew_y, side, compared, factor);
    const auto first_of = [&](std::int32_t from, std::int32_t skew) {
        return (from - skew + factor - 1) / factor;
    };
    const auto last_of = [&](std::int32_t from, std::int32_t length, std::int32_t skew) {
        return (from + length - 1 - skew) / factor;
    };
    const std::int32_t left = std::max(0, first_of(window.left, skew_x)),
                       top = std::max(0, first_of(window.top, skew_y));
    const std::int32_t columns = last_of(window.left, window.width, skew_x) - left + 1;
    const std::int32_t rows = last_of(window.top, window.height, skew_y) - top + 1;

    std::vector<Candidate> found;
    std::vector<std::uint32_t> sums(static_cast<std::size_t>(std::max(columns, 0)));
    for (std::int32_t row = 0; row < rows && columns > 0; ++row) {
        const std::int32_t displaced = ((top + row) * factor + skew_y - y) & (tile_.side - 1);
        if (displaced < band.first || displaced >= band.first + band.rows) continue;
        std::fill(sums.begin(), sums.end(), 0);
        for (const TileTexel& texel : coarse) {
            const auto i =
                static_cast<std::size_t>(top + row + texel.y) * static_cast<std::size_t>(photo.width) +
                static_cast<std::size_t>(left + texel.x);
            const std::int16_t *l = &photo.lightness[i], *g = &photo.green_red[i], *b = &photo.blue_yellow[i];
            const std::int32_t tl = texel.color.lightness, tg = texel.color.green_red,
                               tb = texel.color.blue_yellow;
            // Sixteenths of at most 4·10⁶, and at most 16² texels: no sum overflows
            for (std::int32_t column = 0; column < columns; ++column) {
                const std::int32_t dl = l[column] - tl, dg = g[column] - tg, db = b[column] - tb;
                sums[static_cast<std::size_t>(column)] +=
                    static_cast<std::uint32_t>(dl * dl + dg * dg + db * db) >> 4;
            }
        }
        for (std::int32_t column = 0; column < columns; ++column)
            found.push_back({sums[static_cast<std::size_t>(column)],
                             {(left + column) * factor + skew_x, (top + row) * factor + skew_y}});
    }

    // The best that lie apart, then texel by texel around each
    const std::size_t sorted = std::min(found.size(), 64 * count);
    std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(sorted), found.end());
    std::vector<Candidate> chosen;
    for (std::size_t i = 0; i < sorted && chosen.size() < count; ++i) {
        const auto far_from = [&](const Candidate& c) {
            return lie_apart(c.at, found[i].at, std::max(2, side / 8));
        };
        if (std::all_of(chosen.begin(), chosen.end(), far_from) && !shows_the_same(x, y, side, found[i].at))
            chosen.push_back(found[i]);
    }
    while (factor > 1) {
        factor /= 2;
        const std::int32_t off_x = x & (factor - 1), off_y = y & (factor - 1);
        const std::vector<TileTexel> texels = compared_texels(x - off_x, y - off_y, side, compared, factor);
        const Reduced& finer = photos_.at(factor);
        for (Candidate& candidate : chosen) {
            const Offset centre = candidate.at;
            candidate.cost = ~std::uint64_t{0};
            for (std::int32_t i = 0; i < 9; ++i) {
                const Offset at{centre.x + (i % 3 - 1) * factor, centre.y + (i / 3 - 1) * factor};
                if (at.x < window.left || at.y < window.top || at.x >= window.left + window.width ||
                    at.y >= window.top + window.height)
                    continue;
                const std::int32_t column = (at.x - off_x) / factor, row = (at.y - off_y) / factor;
                if (at.x < off_x || at.y < off_y) continue;
                std::uint64_t sum = 0;
                for (const TileTexel& texel : texels) {
                    const auto k =
                        static_cast<std::size_t>(row + texel.y) * static_cast<std::size_t>(finer.width) +
                        static_cast<std::size_t>(column + texel.x);
                    sum += static_cast<std::uint64_t>(difference(
                        texel.color, {finer.lightness[k], finer.green_red[k], finer.blue_yellow[k]}));
                }
                candidate = std::min(candidate, Candidate{sum, at});
            }
        }
    }
    std::sort(chosen.begin(), chosen.end());
    std::vector<Offset> places;
    for (const Candidate& candidate : chosen) places.push_back(candidate.at);
    return places;
}

}  // namespace tessera
