#include "server/prepare/tile.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <tuple>

#include "server/prepare/parallel.h"
#include "server/prepare/torus_cut.h"

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
/// Freeman, "Image quilting", SIGGRAPH 2001), by dynamic programming: quick, and never much cheaper than a
/// cut that may run anywhere.
Cut cheapest_cut(const CutCosts& costs) {
    const std::int32_t first = 1, last = costs.positions - 1;
    std::vector<std::uint64_t> sums(static_cast<std::size_t>(costs.positions), unreachable);
    std::vector<std::uint64_t> next = sums;
    std::vector<std::int8_t> steps(static_cast<std::size_t>(costs.lines) *
                                   static_cast<std::size_t>(costs.positions));
    for (std::int32_t p = first; p <= last; ++p) sums[static_cast<std::size_t>(p)] = costs.at(0, p);
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
        if (sums[static_cast<std::size_t>(p)] < cut.cost) {
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

/// The first cut's zone runs down the left side, the second's across the top of what the first one leaves.
struct Cuts {
    Cut left, top;
    std::uint64_t seam_cost = 0;
    std::uint64_t activity = 1;  ///< Mean difference of diagonal neighbours in the photograph there.
};

/// Where a texel is from: left of the first cut the photograph goes on from the tile's right side.
std::int32_t source_x(const Cut& left, Place place, std::int32_t side, std::int32_t x, std::int32_t line) {
    return place.x + (x < left.at[static_cast<std::size_t>(line)] ? x + side : x);
}

/// The tile's left `overlap` columns show what lies right of it in the photograph, up to a cut; then its
/// upper rows, of that, what lies below. What the best cuts cost tells good places from bad ones.
Cuts make_cuts(const PerceptualImage& photo, Place place, std::int32_t side, std::int32_t overlap) {
    Cuts cuts;
    const CutCosts across =
        make_costs(side + overlap, overlap, [&](std::int32_t line, std::int32_t position) {
            return difference(photo.at(place.x + position, place.y + line),
                              photo.at(place.x + side + position, place.y + line));
        });
    cuts.left = cheapest_cut(across);
    const CutCosts down = make_costs(side, overlap, [&](std::int32_t x, std::int32_t position) {
        const std::int32_t below = position + side;
        return difference(photo.at(source_x(cuts.left, place, side, x, position), place.y + position),
                          photo.at(source_x(cuts.left, place, side, x, below), place.y + below));
    });
    cuts.top = cheapest_cut(down);

    // Of the first cut only the lines that the tile shows
    cuts.seam_cost = cuts.top.cost;
    const std::int32_t shown = cuts.top.at.front();
    for (std::int32_t line = shown; line < shown + side; ++line)
        cuts.seam_cost += across.at(line, cuts.left.at[static_cast<std::size_t>(line)]);
    std::uint64_t sum = 0;
    for (std::int32_t y = place.y; y < place.y + side; ++y)
        for (std::int32_t x = place.x; x < place.x + side; ++x)
            sum += static_cast<std::uint64_t>(difference(photo.at(x, y), photo.at(x + 1, y + 1)));
    cuts.activity += sum / (static_cast<std::uint64_t>(side) * static_cast<std::uint64_t>(side));
    return cuts;
}

/// Places on a grid all over the photograph.
std::vector<Place> make_places(std::int32_t free_x, std::int32_t free_y) {
    const std::int32_t last_i = std::min(places_per_axis - 1, free_x);
    const std::int32_t last_j = std::min(places_per_axis - 1, free_y);
    std::vector<Place> places;
    for (std::int32_t j = 0; j <= last_j; ++j)
        for (std::int32_t i = 0; i <= last_i; ++i)
            places.push_back({last_i == 0 ? 0 : free_x * i / last_i, last_j == 0 ? 0 : free_y * j / last_j});
    return places;
}

}  // namespace

PeriodicTile make_tile(const PerceptualImage& photo, std::int32_t side, std::size_t threads,
                       Progress& progress) {
    const std::int32_t spare = std::min(photo.width, photo.height) - side;
    const std::int32_t overlap = std::clamp(std::min(side / 4, 128), least_overlap(side), spare);
    const std::vector<Place> places =
        make_places(photo.width - side - overlap, photo.height - side - overlap);

    // Minimum cuts take far longer, and cost hardly less: only the best places get them
    std::vector<Cuts> cuts(places.size());
    std::vector<std::size_t> order(places.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const std::size_t finalists = std::min<std::size_t>(places.size(), 6);
    std::atomic<std::size_t> done{0};
    const auto advance = [&] {
        progress.advance("tile",
                         static_cast<double>(++done) / static_cast<double>(places.size() + finalists));
    };
    for_each_index(places.size(), threads, [&](std::size_t i) {
        if (progress.stop().stop_requested()) return;
        cuts[i] = make_cuts(photo, places[i], side, overlap);
        advance();
    });

    // What is cheap to cut and neither duller nor busier than the photograph: in its flat corners all is
    // cheap
    std::uint64_t usual = 0;
    for (const Cuts& tried : cuts) usual += tried.activity;
    usual /= cuts.size();
    const auto price = [&](std::uint64_t seam_cost, std::size_t i) {
        const std::uint64_t most = std::max(cuts[i].activity, usual),
                            least = std::min(cuts[i].activity, usual);
        return seam_cost * (256 * most / std::max<std::uint64_t>(1, least));
    };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::tuple{price(cuts[a].seam_cost, a), a} < std::tuple{price(cuts[b].seam_cost, b), b};
    });
    order.resize(finalists);
    std::vector<PeriodicTile> tiles(finalists);
    for_each_index(finalists, threads, [&](std::size_t i) {
        if (progress.stop().stop_requested()) return;
        const Place place = places[order[i]];
        tiles[i] = cut_on_torus(photo, {place.x, place.y}, side, overlap, cuts[order[i]].top.at.front());
        advance();
    });
    if (progress.stop().stop_requested()) return {};
    std::size_t best = 0;
    for (std::size_t i = 1; i < finalists; ++i)
        if (price(tiles[i].seam_cost, order[i]) < price(tiles[best].seam_cost, order[best])) best = i;
    return std::move(tiles[best]);
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
