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

std::vector<PlaceSearch::RingTexel> PlaceSearch::ring(std::int32_t x, std::int32_t y, std::int32_t side,
                                                      const std::vector<std::uint8_t>& taken,
                                                      std::int32_t factor) const {
    const PerceptualImage& tile = tiles_.at(factor);
    const std::int32_t wrap = tile.width - 1, cells = side / factor;
    std::vector<RingTexel> texels;
    for (std::int32_t v = 0; v < cells; ++v)
        for (std::int32_t u = 0; u < cells; ++u) {
            const std::int32_t height = bell(u, v, cells);
            if (height < 70 || height > 190) continue;
            const std::int32_t middle_x = (x + u * factor + factor / 2) & (tile_.side - 1);
            const std::int32_t middle_y = (y + v * factor + factor / 2) & (tile_.side - 1);
            if (!taken.empty() && taken[static_cast<std::size_t>(middle_y * tile_.side + middle_x)] != 0)
                continue;
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
                                      const std::vector<std::uint8_t>& taken, const Window& window,
                                      std::size_t count) const {
    std::int32_t factor = factor_of(side);
    const Reduced& photo = photos_.at(factor);
    // On the grid of reduced texels, of the tile and of the photograph
    const std::int32_t skew_x = x & (factor - 1), skew_y = y & (factor - 1);
    const std::vector<RingTexel> coarse = ring(x - skew_x, y - skew_y, side, taken, factor);
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
        std::fill(sums.begin(), sums.end(), 0);
        for (const RingTexel& texel : coarse) {
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
    const Window all = everywhere(side);
    while (factor > 1) {
        factor /= 2;
        const std::int32_t off_x = x & (factor - 1), off_y = y & (factor - 1);
        const std::vector<RingTexel> texels = ring(x - off_x, y - off_y, side, taken, factor);
        const Reduced& finer = photos_.at(factor);
        for (Candidate& candidate : chosen) {
            const Offset centre = candidate.at;
            candidate.cost = ~std::uint64_t{0};
            for (std::int32_t i = 0; i < 9; ++i) {
                const Offset at{centre.x + (i % 3 - 1) * factor, centre.y + (i / 3 - 1) * factor};
                if (at.x < all.left || at.y < all.top || at.x >= all.left + all.width ||
                    at.y >= all.top + all.height)
                    continue;
                const std::int32_t column = (at.x - off_x) / factor, row = (at.y - off_y) / factor;
                if (at.x < off_x || at.y < off_y) continue;
                std::uint64_t sum = 0;
                for (const RingTexel& texel : texels) {
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
