#include "server/prepare/patches.h"

#include <algorithm>
#include <cstdlib>
#include <queue>
#include <tuple>

#include "shared/math/hash.h"

namespace tessera {
namespace {

/// Tried on photographs from 0 to 2: more of it, weaker seams at as little repetition.
constexpr std::uint64_t deviation_weight = 2;

/// A place on the torus where a patch starts to grow.
struct Seed {
    std::int32_t x = 0, y = 0;
};

/// The grid of cells that holds one seed each.
struct Grid {
    std::int32_t columns = 0, rows = 0;
};

Grid grid_of(std::int32_t count) {
    Grid grid{1, 1};
    while ((grid.rows + 1) * (grid.rows + 1) <= count) ++grid.rows;
    grid.columns = (count + grid.rows / 2) / grid.rows;
    return grid;
}

/// A seed somewhere in the middle of each cell; `jitter` is the part of the cell, in 1/64, that it may be in.
std::vector<Seed> scatter(Grid grid, std::int32_t side, std::int32_t jitter, std::uint64_t seed) {
    constexpr std::uint64_t across = stream("patch seed across");
    constexpr std::uint64_t down = stream("patch seed down");
    std::vector<Seed> seeds;
    const auto place = [&](std::int32_t i, std::int32_t cells, std::uint64_t bits) {
        const std::int32_t from = side * i / cells;
        const std::int32_t room = side * (i + 1) / cells - from;
        const std::int32_t free = std::max(1, room * jitter / 64);
        return from + (room - free) / 2 +
               static_cast<std::int32_t>(uniform_below(bits, static_cast<std::uint32_t>(free)));
    };
    for (std::int32_t j = 0; j < grid.rows; ++j)
        for (std::int32_t i = 0; i < grid.columns; ++i)
            seeds.push_back({place(i, grid.columns, hash(seed, across, i, j)),
                             place(j, grid.rows, hash(seed, down, i, j))});
    return seeds;
}

/// Adds to each texel's gradient how far its lightness is from the tile's mean, squared: on average `weight`
/// times the mean gradient.
void add_deviations(std::vector<std::uint64_t>& gradient, const PerceptualImage& tile, std::uint64_t weight) {
    const std::int64_t texels = std::ssize(tile.colors);
    std::int64_t lightness = 0;
    std::uint64_t gradients = 0, squares = 0;
    for (const PerceptualColor& color : tile.colors) lightness += color.lightness;
    const auto squared_deviation = [mean = lightness / texels](const PerceptualColor& color) {
        return static_cast<std::uint64_t>((color.lightness - mean) * (color.lightness - mean));
    };
    for (const PerceptualColor& color : tile.colors) squares += squared_deviation(color);
    for (const std::uint64_t one : gradient) gradients += one;
    const std::uint64_t mean_square = squares / static_cast<std::uint64_t>(texels) + 1;
    const std::uint64_t mean_gradient = gradients / static_cast<std::uint64_t>(texels);
    for (std::size_t i = 0; i < gradient.size(); ++i)
        gradient[i] += weight * mean_gradient * squared_deviation(tile.colors[i]) / mean_square;
}

/// How much goes on around each texel: the gradient, summed over a box of 2·radius + 1 on the torus, as its
/// rank among all texels, 0 (quiet) to 255, so that the photograph's contrast does not matter.
std::vector<std::uint8_t> activity(const PerceptualImage& tile, std::int32_t radius, BorderPlaces places) {
    const std::int32_t side = tile.width, mask = side - 1;
    const auto index = [&](std::int32_t x, std::int32_t y) {
        return static_cast<std::size_t>((y & mask) * side + (x & mask));
    };
    std::vector<std::uint64_t> gradient(tile.colors.size()), rows(tile.colors.size()),
        sums(tile.colors.size());
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const PerceptualColor here = tile.at(x, y);
            gradient[index(x, y)] = static_cast<std::uint64_t>(difference(here, tile.at((x + 1) & mask, y)) +
                                                               difference(here, tile.at(x, (y + 1) & mask)));
        }
    if (places == BorderPlaces::quiet_and_of_mean_lightness) add_deviations(gradient, tile, deviation_weight);
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            for (std::int32_t d = -radius; d <= radius; ++d) rows[index(x, y)] += gradient[index(x + d, y)];
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            for (std::int32_t d = -radius; d <= radius; ++d) sums[index(x, y)] += rows[index(x, y + d)];

    std::vector<std::uint64_t> sorted = sums;
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint8_t> ranks(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const auto below = std::lower_bound(sorted.begin(), sorted.end(), sums[i]) - sorted.begin();
        ranks[i] = static_cast<std::uint8_t>(below * 256 / std::ssize(sorted));
    }
    return ranks;
}

/// All seeds grow at once, each texel going to the seed that reaches it first (Dijkstra). Quiet texels take
/// long to cross, so that fronts meet there; and every step takes longer by `compactness` with the distance
/// from the seed. Equal times go to the lower label, then the lower texel: no order is left to chance.
std::vector<std::uint16_t> grow(const std::vector<Seed>& seeds, const std::vector<std::uint8_t>& active,
                                std::int32_t side, std::int64_t cell, std::int64_t compactness) {
    using Front = std::tuple<std::int64_t, std::uint16_t, std::int32_t>;  // time, label, texel
    std::priority_queue<Front, std::vector<Front>, std::greater<>> fronts;
    const std::int32_t mask = side - 1;
    constexpr std::uint16_t nobody = 65535;
    std::vector<std::uint16_t> labels(active.size(), nobody);
    for (std::size_t i = 0; i < seeds.size(); ++i)
        fronts.emplace(0, static_cast<std::uint16_t>(i), seeds[i].y * side + seeds[i].x);
    const auto apart = [&](std::int32_t a, std::int32_t b) {
        const std::int32_t d = (a - b) & mask;
        return std::min(d, side - d);
    };
    while (!fronts.empty()) {
        const std::int64_t time = std::get<0>(fronts.top());
        const std::uint16_t label = std::get<1>(fronts.top());
        const std::int32_t texel = std::get<2>(fronts.top());
        fronts.pop();
        if (labels[static_cast<std::size_t>(texel)] != nobody) continue;
        labels[static_cast<std::size_t>(texel)] = label;
        const std::int32_t x = texel & mask, y = texel / side;
        const Seed seed = seeds[label];
        const auto visit = [&](std::int32_t to_x, std::int32_t to_y) {
            const std::int32_t to = (to_y & mask) * side + (to_x & mask);
            if (labels[static_cast<std::size_t>(to)] != nobody) return;
            const std::int64_t pace = 16 + 255 - active[static_cast<std::size_t>(to)];
            const std::int64_t away = std::max(apart(to_x & mask, seed.x), apart(to_y & mask, seed.y));
            fronts.emplace(time + pace * (64 * cell + compactness * away) / cell, label, to);
        };
        visit(x - 1, y);
        visit(x + 1, y);
        visit(x, y - 1);
        visit(x, y + 1);
    }
    return labels;
}

/// The shortest arc of the circle of `used.size()` places that holds all that are used: start and length.
std::pair<std::int32_t, std::int32_t> shortest_arc(const std::vector<bool>& used) {
    const auto side = static_cast<std::int32_t>(used.size());
    // The longest gap; the arc is the rest
    std::int32_t start = 0, longest = -1, gap = 0;
    for (std::int32_t i = 0; i < 2 * side; ++i) {
        if (!used[static_cast<std::size_t>(i % side)]) {
            ++gap;
        } else {
            if (gap > longest && gap < side && i >= gap) {
                longest = gap;
                start = i % side;
            }
            gap = 0;
        }
    }
    return {start, side - std::max(longest, 0)};
}

struct Extents {
    std::vector<ExchangeAsset::Patch> boxes;
    std::vector<std::int64_t> areas;
};

Extents measure(const std::vector<std::uint16_t>& labels, std::size_t count, std::int32_t side) {
    Extents out{std::vector<ExchangeAsset::Patch>(count), std::vector<std::int64_t>(count)};
    std::vector<std::vector<bool>> columns(count, std::vector<bool>(static_cast<std::size_t>(side))),
        rows = columns;
    for (std::int32_t y = 0, i = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x, ++i) {
            const std::size_t label = labels[static_cast<std::size_t>(i)];
            columns[label][static_cast<std::size_t>(x)] = true;
            rows[label][static_cast<std::size_t>(y)] = true;
            ++out.areas[label];
        }
    for (std::size_t p = 0; p < count; ++p) {
        std::tie(out.boxes[p].x, out.boxes[p].width) = shortest_arc(columns[p]);
        std::tie(out.boxes[p].y, out.boxes[p].height) = shortest_arc(rows[p]);
    }
    return out;
}

}  // namespace

Segmentation make_patches(const PerceptualImage& tile, std::int32_t count, std::uint64_t seed,
                          BorderPlaces places) {
    const std::int32_t side = tile.width;
    const Grid grid = grid_of(count);
    const std::int64_t cell = side / std::max(grid.columns, grid.rows);
    const std::vector<std::uint8_t> active =
        activity(tile, static_cast<std::int32_t>(std::clamp<std::int64_t>(cell / 16, 1, 4)), places);

    // Freely first; then rounder and more regular, until every box fits
    std::int32_t jitter = 32;
    for (std::int64_t compactness = 64;; compactness *= 2, jitter /= 2) {
        std::vector<Seed> seeds = scatter(grid, side, jitter, seed);
        std::vector<std::uint16_t> labels =
            grow(seeds, active, side, std::max<std::int64_t>(cell, 1), compactness);
        Extents extents = measure(labels, seeds.size(), side);

        // A seed that got next to nothing leaves its land to its neighbours
        const std::int64_t least = std::int64_t{side} * side / std::ssize(seeds) / 6;
        std::vector<Seed> kept;
        for (std::size_t p = 0; p < seeds.size(); ++p)
            if (extents.areas[p] >= least) kept.push_back(seeds[p]);
        if (kept.size() < seeds.size() && compactness < 4096) {
            seeds = kept;
            labels = grow(seeds, active, side, std::max<std::int64_t>(cell, 1), compactness);
            extents = measure(labels, seeds.size(), side);
        }
        const bool fits = std::all_of(extents.boxes.begin(), extents.boxes.end(), [&](const auto& box) {
            return box.width <= side / 2 && box.height <= side / 2;
        });
        if (fits || compactness > (1 << 20)) return {std::move(labels), std::move(extents.boxes)};
    }
}

}  // namespace tessera
