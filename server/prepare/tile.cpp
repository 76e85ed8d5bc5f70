#include "server/prepare/tile.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <limits>

#include "server/prepare/parallel.h"

namespace tessera {
namespace {

constexpr std::uint64_t unreachable = std::numeric_limits<std::uint64_t>::max() / 4;
constexpr std::int32_t places_per_axis = 7;

/// A place of the photograph to cut the tile from: side + overlap texels each way.
struct Place {
    std::int32_t x = 0, y = 0;
};

/// A cut through the zone where two images lie over each other: in line i the one ends and the other begins
/// before position cut[i], 1 to overlap − 1.
struct Cut {
    std::vector<std::int32_t> at;
    std::uint64_t cost = unreachable;
};

/// What a cut before each position of each line would cost: the images' differences on both sides of it
/// (Kwatra et al., "Graphcut textures", ACM TOG 22(3), 2003, equation 1).
struct CutCosts {
    std::int32_t lines = 0, positions = 0;
    std::vector<std::uint32_t> costs;
    std::uint32_t at(std::int32_t line, std::int32_t position) const noexcept {
        return costs[static_cast<std::size_t>(line) * static_cast<std::size_t>(positions) +
                     static_cast<std::size_t>(position)];
    }
};

/// `differ(line, position)` compares the two images at one texel of the zone.
template <class Differ>
CutCosts make_costs(std::int32_t lines, std::int32_t positions, const Differ& differ) {
    CutCosts out{lines, positions, {}};
    out.costs.reserve(static_cast<std::size_t>(lines) * static_cast<std::size_t>(positions));
    for (std::int32_t line = 0; line < lines; ++line) {
        std::uint32_t before = 0;
        for (std::int32_t position = 0; position < positions; ++position) {
            const auto here = static_cast<std::uint32_t>(differ(line, position));
            out.costs.push_back(before + here);
            before = here;
        }
    }
    return out;
}

/// The cheapest cut from the first line to the last that moves by at most one position a line (Efros,
/// Freeman, "Image quilting", SIGGRAPH 2001), by dynamic programming. If `start` is given, the cut begins
/// there and ends within one position of it.
Cut cheapest_cut(const CutCosts& costs, std::int32_t start = -1) {
    const std::int32_t first = 1, last = costs.positions - 1;
    std::vector<std::uint64_t> sums(static_cast<std::size_t>(costs.positions), unreachable);
    std::vector<std::uint64_t> next = sums;
    std::vector<std::int8_t> steps(static_cast<std::size_t>(costs.lines) *
                                   static_cast<std::size_t>(costs.positions));
    for (std::int32_t p = first; p <= last; ++p)
        if (start < 0 || p == start) sums[static_cast<std::size_t>(p)] = costs.at(0, p);
    for (std::int32_t line = 1; line < costs.lines; ++line) {
        std::int8_t* step =
            steps.data() + static_cast<std::size_t>(line) * static_cast<std::size_t>(costs.positions);
        for (std::int32_t p = first; p <= last; ++p) {
            const auto i = static_cast<std::size_t>(p);
            std::uint64_t best = sums[i];
            step[i] = 0;
            if (p > first && sums[i - 1] < best) {
                best = sums[i - 1];
                step[i] = -1;
            }
            if (p < last && sums[i + 1] < best) {
                best = sums[i + 1];
                step[i] = 1;
            }
            next[i] = best >= unreachable ? unreachable : best + costs.at(line, p);
        }
        std::swap(sums, next);
    }
    Cut cut;
    std::int32_t end = first;
    for (std::int32_t p = first; p <= last; ++p)
        if ((start < 0 || std::abs(p - start) <= 1) && sums[static_cast<std::size_t>(p)] < cut.cost) {
            cut.cost = sums[static_cast<std::size_t>(p)];
            end = p;
        }
    cut.at.resize(static_cast<std::size_t>(costs.lines));
    for (std::int32_t line = costs.lines - 1; line >= 0; --line) {
        cut.at[static_cast<std::size_t>(line)] = end;
        end += steps[static_cast<std::size_t>(line) * static_cast<std::size_t>(costs.positions) +
                     static_cast<std::size_t>(end)];
    }
    return cut;
}

/// The cheapest cut whose end meets its beginning: a loop around the torus.
Cut cheapest_loop(const CutCosts& costs) {
    Cut best;
    for (std::int32_t start = 1; start < costs.positions; ++start)
        if (Cut cut = cheapest_cut(costs, start); cut.cost < best.cost) best = std::move(cut);
    return best;
}

/// Cuts one tile. Its left `overlap` columns show what lies right of it in the photograph, up to a cut; then
/// its upper rows, of that, what lies below, up to a cut that closes on itself.
PeriodicTile cut_tile(const PerceptualImage& photo, Place place, std::int32_t side, std::int32_t overlap) {
    const std::int32_t tall = side + overlap;
    const CutCosts across = make_costs(tall, overlap, [&](std::int32_t line, std::int32_t position) {
        return difference(photo.at(place.x + position, place.y + line),
                          photo.at(place.x + side + position, place.y + line));
    });
    const Cut left = cheapest_cut(across);
    const auto source_x = [&](std::int32_t x, std::int32_t line) {
        return place.x + (x < left.at[static_cast<std::size_t>(line)] ? x + side : x);
    };
    const CutCosts down = make_costs(side, overlap, [&](std::int32_t x, std::int32_t position) {
        const std::int32_t below = position + side;
        return difference(photo.at(source_x(x, position), place.y + position),
                          photo.at(source_x(x, below), place.y + below));
    });
    const Cut top = cheapest_loop(down);

    PeriodicTile tile{side, overlap, {}, top.cost, 0};
    tile.sources.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::int32_t line = y < top.at[static_cast<std::size_t>(x)] ? y + side : y;
            tile.sources.push_back({source_x(x, line), place.y + line});
        }
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            tile.activity += static_cast<std::uint64_t>(
                difference(photo.at(place.x + x, place.y + y), photo.at(place.x + x + 1, place.y + y + 1)));
    tile.activity = tile.activity / (static_cast<std::uint64_t>(side) * static_cast<std::uint64_t>(side)) + 1;
    // Of the first cut only the lines that the tile shows
    const std::int32_t shown = top.at.front();
    for (std::int32_t line = shown; line < shown + side; ++line)
        tile.seam_cost += across.at(line, left.at[static_cast<std::size_t>(line)]);
    return tile;
}

}  // namespace

PeriodicTile make_tile(const PerceptualImage& photo, std::int32_t side, std::size_t threads,
                       Progress& progress) {
    const std::int32_t spare = std::min(photo.width, photo.height) - side;
    const std::int32_t overlap = std::clamp(std::min(side / 4, 128), least_overlap(side), spare);
    const std::int32_t free_x = photo.width - side - overlap;
    const std::int32_t free_y = photo.height - side - overlap;
    std::vector<Place> places;
    for (std::int32_t j = 0; j < std::min(places_per_axis, free_y + 1); ++j)
        for (std::int32_t i = 0; i < std::min(places_per_axis, free_x + 1); ++i) {
            const std::int32_t last_i = std::min(places_per_axis - 1, free_x);
            const std::int32_t last_j = std::min(places_per_axis - 1, free_y);
            places.push_back({last_i == 0 ? 0 : free_x * i / last_i, last_j == 0 ? 0 : free_y * j / last_j});
        }

    std::vector<PeriodicTile> tiles(places.size());
    std::atomic<std::size_t> done{0};
    for_each_index(places.size(), threads, [&](std::size_t i) {
        if (progress.stop().stop_requested()) return;
        tiles[i] = cut_tile(photo, places[i], side, overlap);
        progress.advance("tile", static_cast<double>(++done) / static_cast<double>(places.size()));
    });
    if (progress.stop().stop_requested()) return tiles.front();
    // What is cheap to cut and no duller or busier than the photograph: in its flat corners every cut is
    // cheap
    std::uint64_t usual = 0;
    for (const PeriodicTile& tile : tiles) usual += tile.activity;
    usual /= tiles.size();
    const auto price = [&](const PeriodicTile& tile) {
        const auto [least, most] = std::minmax(tile.activity, usual);
        return tile.seam_cost * (256 * most / least);
    };
    return *std::min_element(tiles.begin(), tiles.end(), [&](const PeriodicTile& a, const PeriodicTile& b) {
        return price(a) < price(b);
    });
}

Rgb8Image cut_out(const Rgb8Image& photo, const PeriodicTile& tile) {
    Rgb8Image out{tile.side, tile.side, {}};
    out.bytes.reserve(3 * tile.sources.size());
    for (const PhotoPoint source : tile.sources) {
        const auto texel = photo.bytes.begin() + 3 * (std::ptrdiff_t{source.y} * photo.width + source.x);
        out.bytes.insert(out.bytes.end(), texel, texel + 3);
    }
    return out;
}

}  // namespace tessera
