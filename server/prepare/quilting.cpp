#include "server/prepare/quilting.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <tuple>

#include "server/prepare/graph_cut.h"
#include "server/prepare/parallel.h"
#include "server/prepare/seam.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

/// How blocks are laid: `count` a row, one every `step` texels, each `side` = step + overlap wide.
struct Layout {
    std::int32_t step = 0, overlap = 0, side = 0, count = 0;
};

/// Blocks as large as the photograph gives room to choose among, so that large features stay whole.
Layout layout_of(const PerceptualImage& photo, std::int32_t side) {
    const std::int32_t room = std::min(photo.width, photo.height);
    Layout layout;
    layout.step = side / 2;
    while (layout.step > 8 && layout.step + layout.step * 3 / 8 > room * 5 / 8) layout.step /= 2;
    layout.overlap = std::max(4, layout.step * 3 / 8);
    layout.side = layout.step + layout.overlap;
    layout.count = side / layout.step;
    return layout;
}

/// A tile on its way.
struct Quilt {
    QuiltedTile tile;
    std::vector<std::uint8_t> laid;  ///< side²: something is there.

    explicit Quilt(std::int32_t side) {
        const auto texels = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
        tile.side = side;
        tile.sources.resize(texels);
        tile.colors = {side, side, std::vector<PerceptualColor>(texels)};
        laid.resize(texels);
    }
    std::size_t index(std::int32_t x, std::int32_t y) const noexcept {
        return static_cast<std::size_t>((y & (tile.side - 1)) * tile.side + (x & (tile.side - 1)));
    }
};

/// A texel of the block that lies on something: what a block must match.
struct Known {
    std::int32_t x = 0, y = 0;
    PerceptualColor color;
};

std::vector<Known> known_texels(const Quilt& quilt, std::int32_t left, std::int32_t top, std::int32_t side,
                                std::int32_t stride) {
    std::vector<Known> known;
    for (std::int32_t y = 0; y < side; y += stride)
        for (std::int32_t x = (y / stride % 2) * (stride / 2); x < side; x += stride)
            if (quilt.laid[quilt.index(left + x, top + y)])
                known.push_back({x, y, quilt.tile.color(left + x, top + y)});
    return known;
}

std::uint64_t misfit(const PerceptualImage& photo, const std::vector<Known>& known, PhotoPoint at) {
    std::uint64_t sum = 0;
    for (const Known& texel : known)
        sum += static_cast<std::uint64_t>(difference(texel.color, photo.at(at.x + texel.x, at.y + texel.y)));
    return sum;
}

struct Place {
    std::uint64_t misfit = 0;
    PhotoPoint at;
    bool operator<(const Place& other) const {
        return std::tuple{misfit, at.y, at.x} < std::tuple{other.misfit, other.at.y, other.at.x};
    }
};

/// Where in the photograph the block fits best: a coarse grid of places and texels, then ever finer around
/// the best.
PhotoPoint best_place(const PerceptualImage& photo, const Quilt& quilt, std::int32_t left, std::int32_t top,
                      std::int32_t side) {
    std::int32_t step = 1;
    while (step < 8 && side / step > 24) step *= 2;
    std::vector<Place> places;
    const std::vector<Known> sparse = known_texels(quilt, left, top, side, 2 * step);
    for (std::int32_t y = 0; y + side <= photo.height; y += step)
        for (std::int32_t x = 0; x + side <= photo.width; x += step)
            places.push_back({misfit(photo, sparse, {x, y}), {x, y}});
    const std::size_t kept = std::min<std::size_t>(places.size(), 24);
    std::partial_sort(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(kept), places.end());
    places.resize(kept);
    while (step > 1) {
        step /= 2;
        const std::vector<Known> known = known_texels(quilt, left, top, side, std::max(1, step));
        for (Place& place : places) {
            const PhotoPoint centre = place.at;
            place.misfit = misfit(photo, known, centre);
            for (std::int32_t i = 0; i < 9; ++i) {
                const PhotoPoint at{centre.x + (i % 3 - 1) * step, centre.y + (i / 3 - 1) * step};
                if (at.x < 0 || at.y < 0 || at.x + side > photo.width || at.y + side > photo.height) continue;
                place = std::min(place, Place{misfit(photo, known, at), at});
            }
        }
    }
    return std::min_element(places.begin(), places.end())->at;
}

/// Lays the photograph's block over what is there, divided where it shows least.
void lay_block(Quilt& quilt, const PerceptualImage& photo, std::int32_t left, std::int32_t top,
               std::int32_t side, PhotoPoint at) {
    CutGrid grid{side, side};
    const auto is_laid = [&](std::int32_t x, std::int32_t y) {
        return quilt.laid[quilt.index(left + x, top + y)] != 0;
    };
    const auto price = [&](std::int32_t x, std::int32_t y, std::int32_t u, std::int32_t v) -> std::uint32_t {
        const bool here = is_laid(x, y), there = is_laid(u, v);
        if (!here && !there) return 0;
        const PerceptualColor a_s = photo.at(at.x + x, at.y + y), a_t = photo.at(at.x + u, at.y + v);
        // Where nothing lies the block will: a border there is seen from one side only
        const PerceptualColor b_s = here ? quilt.tile.color(left + x, top + y) : a_s;
        const PerceptualColor b_t = there ? quilt.tile.color(left + u, top + v) : a_t;
        return seam_price(a_s, a_t, b_s, b_t);
    };
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::size_t i = grid.index(x, y);
            const bool rim = x == 0 || y == 0 || x == side - 1 || y == side - 1;
            if (!is_laid(x, y))
                grid.outside[i] = CutGrid::must;
            else if (rim)
                grid.inside[i] = CutGrid::must;
            if (x + 1 < side) grid.right[i] = price(x, y, x + 1, y);
            if (y + 1 < side) grid.below[i] = price(x, y, x, y + 1);
        }
    const ShapeCut cut = cheapest_shape(grid);
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            if (!cut.shape.at(x, y)) continue;
            const std::size_t i = quilt.index(left + x, top + y);
            quilt.laid[i] = 1;
            quilt.tile.sources[i] = {at.x + x, at.y + y};
            quilt.tile.colors.colors[i] = photo.at(at.x + x, at.y + y);
        }
    quilt.tile.seam_cost += cut.cost;
}

/// One tile, begun with the photograph's block at `first`. The side of a block is at most the photograph's.
QuiltedTile quilt_from(const PerceptualImage& photo, std::int32_t side, const Layout& layout,
                       PhotoPoint first, const Progress& progress) {
    Quilt quilt{side};
    for (std::int32_t row = 0; row < layout.count; ++row)
        for (std::int32_t column = 0; column < layout.count; ++column) {
            if (progress.stop().stop_requested()) return {};
            const std::int32_t left = column * layout.step, top = row * layout.step;
            const PhotoPoint at =
                row == 0 && column == 0 ? first : best_place(photo, quilt, left, top, layout.side);
            lay_block(quilt, photo, left, top, layout.side, at);
        }
    return std::move(quilt.tile);
}

}  // namespace

QuiltedTile quilt_tile(const PerceptualImage& photo, std::int32_t side, std::uint64_t seed,
                       std::size_t threads, Progress& progress) {
    constexpr std::uint64_t beginnings_stream = stream("quilting");
    constexpr std::size_t most_beginnings = 8;
    const Layout layout = layout_of(photo, side);
    // Large tiles of many blocks have good and bad cuts whatever they begin with
    const auto blocks = static_cast<std::size_t>(layout.count) * static_cast<std::size_t>(layout.count);
    const std::size_t beginnings = std::clamp<std::size_t>(4 * most_beginnings / blocks, 1, most_beginnings);

    std::vector<QuiltedTile> quilts(beginnings);
    std::atomic<std::size_t> done{0};
    for_each_index(beginnings, threads, [&](std::size_t i) {
        const std::uint64_t bits = hash(seed, beginnings_stream, static_cast<std::int64_t>(i), 0);
        const auto across = static_cast<std::uint32_t>(photo.width - layout.side + 1);
        const auto down = static_cast<std::uint32_t>(photo.height - layout.side + 1);
        const PhotoPoint first{static_cast<std::int32_t>(uniform_below(bits, across)),
                               static_cast<std::int32_t>(uniform_below(mix(bits), down))};
        quilts[i] = quilt_from(photo, side, layout, first, progress);
        progress.advance("tile", static_cast<double>(++done) / static_cast<double>(beginnings));
    });
    if (progress.stop().stop_requested()) return {};
    const auto cheaper = [](const QuiltedTile& a, const QuiltedTile& b) { return a.seam_cost < b.seam_cost; };
    return std::move(*std::min_element(quilts.begin(), quilts.end(), cheaper));
}

}  // namespace tessera
