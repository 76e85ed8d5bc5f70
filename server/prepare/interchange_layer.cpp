#include "server/prepare/interchange_layer.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "shared/math/hash.h"

namespace tessera {
namespace {

constexpr std::uint64_t layer_stream = stream("interchange layer");

/// How many contents are cut for each region.
constexpr std::size_t cuts = 10, tried_again = 3;

/// How many of them stay, of a core's size: where little else fits, one region's patches are what there is to
/// choose from.
constexpr std::int32_t large_core = 48;
constexpr std::size_t most_of_large = 4, most_of_small = 2;

/// What a border may show, against the photograph's own steps from texel to texel, and how often it is tried
/// to get there.
constexpr std::uint32_t most_gradient_percent = 122;
constexpr int rounds = 2;

/// What is left of a region is not worth a patch below this.
constexpr std::int32_t least_texels = 24;

/// What of the torus is taken, and how far from it each place is. Kept at a reduced size for large tiles.
class Gaps {
  public:
    explicit Gaps(std::int32_t side)
        : side_{side},
          factor_{std::max(1, side / 256)},
          cells_{side / factor_},
          taken_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side)),
          distances_(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_), far) {}

    /// Marks of the square's first texel at (left, top).
    void take(const SquareMarks& marks, std::int32_t left, std::int32_t top, std::int32_t side) {
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x)
                if (marks[static_cast<std::size_t>(y * side + x)] != 0) take(left + x, top + y);
    }
    void take(std::int32_t x, std::int32_t y) {
        const std::int32_t u = x & (side_ - 1), v = y & (side_ - 1);
        taken_[static_cast<std::size_t>(v * side_ + u)] = 1;
        distances_[cell(u / factor_, v / factor_)] = 0;
    }
    bool is_taken(std::int32_t x, std::int32_t y) const noexcept {
        return taken_[static_cast<std::size_t>((y & (side_ - 1)) * side_ + (x & (side_ - 1)))] != 0;
    }

    struct Gap {
        std::int32_t x = 0, y = 0, radius = 0;  ///< In texels.
    };
    /// A gap for a patch of `wanted` texels' radius: where it fits most closely, so that many do; where none
    /// of that size does, the largest there is. Give or take a quarter, by `bits`.
    Gap next(std::int32_t wanted, std::uint64_t bits) {
        measure();
        Gap best;
        std::int64_t most = -1;
        const std::int64_t full = std::int64_t{3} * wanted / factor_;
        for (std::int32_t y = 0; y < cells_; ++y)
            for (std::int32_t x = 0; x < cells_; ++x) {
                const std::int64_t distance = distances_[cell(x, y)];
                if (distance == 0) continue;
                // Fine enough that few draw the same: among these the first would win
                const std::int64_t jitter =
                    (std::int64_t{3} << 20) + static_cast<std::int64_t>(hash(bits, layer_stream, x, y) >> 44);
                const std::int64_t fit =
                    distance <= full ? distance : std::max(full / 4, 2 * full - distance);
                if (fit * jitter <= most) continue;
                most = fit * jitter;
                best = {x * factor_ + factor_ / 2, y * factor_ + factor_ / 2,
                        static_cast<std::int32_t>(distance * factor_ / 3)};
            }
        return best;
    }

  private:
    static constexpr std::int32_t far = 1 << 20;

    std::size_t cell(std::int32_t x, std::int32_t y) const noexcept {
        return static_cast<std::size_t>((y & (cells_ - 1)) * cells_ + (x & (cells_ - 1)));
    }
    /// Distances in thirds of a cell (Borgefors, "Distance transformations in digital images", 1986: chamfer
    /// 3-4), twice over, since the torus has no beginning.
    void measure() {
        for (std::int32_t turn = 0; turn < 2; ++turn) {
            for (std::int32_t y = 0; y < cells_; ++y)
                for (std::int32_t x = 0; x < cells_; ++x)
                    lower(x, y, {cell(x - 1, y), cell(x, y - 1), cell(x - 1, y - 1), cell(x + 1, y - 1)});
            for (std::int32_t y = cells_ - 1; y >= 0; --y)
                for (std::int32_t x = cells_ - 1; x >= 0; --x)
                    lower(x, y, {cell(x + 1, y), cell(x, y + 1), cell(x + 1, y + 1), cell(x - 1, y + 1)});
        }
    }
    struct Neighbours {
        std::size_t beside, above, diagonal, other_diagonal;
    };
    void lower(std::int32_t x, std::int32_t y, const Neighbours& from) {
        std::int32_t& here = distances_[cell(x, y)];
        here = std::min(here,
                        std::min(std::min(distances_[from.beside], distances_[from.above]) + 3,
                                 std::min(distances_[from.diagonal], distances_[from.other_diagonal]) + 4));
    }

    std::int32_t side_, factor_, cells_;
    std::vector<std::uint8_t> taken_;
    std::vector<std::int32_t> distances_;
};

/// The square of a place, grain by grain.
struct GrainSquare {
    std::int32_t side = 0;
    std::vector<std::uint16_t> grains;
    SquareMarks free;

    GrainSquare(const LayerSources& sources, const Gaps& gaps, const PatchPlace& place) : side{place.side} {
        const std::int32_t tile_side = sources.tile.side, wrap = tile_side - 1;
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x) {
                const std::int32_t i = ((place.y + y) & wrap) * tile_side + ((place.x + x) & wrap);
                grains.push_back(sources.grains.labels[static_cast<std::size_t>(i)]);
                free.push_back(!gaps.is_taken(place.x + x, place.y + y));
            }
    }

    /// The free grains that mostly lie in the shape, and the one in the middle; none from the rim.
    SquareMarks whole_grains(const SquareMarks& shape) const {
        std::map<std::uint16_t, std::int32_t> balance;
        for (std::size_t i = 0; i < grains.size(); ++i) balance[grains[i]] += shape[i] != 0 ? 1 : -1;
        const std::int32_t middle = side / 2 * side + side / 2;
        balance[grains[static_cast<std::size_t>(middle)]] = 1;
        SquareMarks region(grains.size());
        for (std::int32_t y = 1; y + 1 < side; ++y)
            for (std::int32_t x = 1; x + 1 < side; ++x) {
                const auto i = static_cast<std::size_t>(y * side + x);
                region[i] = free[i] != 0 && balance[grains[i]] > 0;
            }
        return region;
    }
};

/// Texels to compare before anything is known of the shape: where the bell lets the border run.
SquareMarks ring_of(const PatchPlace& place, const SquareMarks& free) {
    SquareMarks ring(free.size());
    const std::int32_t margin = (place.side - place.core) / 2;
    for (std::int32_t y = 0; y < place.side; ++y)
        for (std::int32_t x = 0; x < place.side; ++x) {
            const auto i = static_cast<std::size_t>(y * place.side + x);
            const std::int32_t height = bell(x - margin, y - margin, place.core);
            ring[i] = free[i] != 0 && height >= 70 && height <= 190;
        }
    return ring;
}

/// Texels to compare for a patch cut out of a region: those at its border.
SquareMarks band_of(const SquareMarks& region, std::int32_t side) {
    SquareMarks band(region.size());
    const std::vector<std::int32_t> depth = depths(region, side);
    for (std::size_t i = 0; i < band.size(); ++i) band[i] = depth[i] > 0 && depth[i] <= 3 * 5;
    return band;
}

/// The displacements that a patch may have, so that those of one place differ: some at random.
PlaceSearch::Band band_for(const LayerSources& sources, std::uint64_t bits) {
    constexpr std::int32_t bands = 4;
    const std::int32_t rows = std::max(1, sources.tile.side / bands);
    return {static_cast<std::int32_t>((bits >> 32) % std::uint64_t{bands}) * rows, rows};
}

/// Whether a patch of the same region may be shown instead of the best one.
bool as_good(const InterchangePatch& patch, const InterchangePatch& best, std::uint32_t most_gradient) {
    return patch.gradient <= std::max(most_gradient, best.gradient * 27 / 25) &&
           patch.cost * 2 <= best.cost * 3 && patch.texels * 3 >= best.texels * 2;
}

/// The cheapest patches of a region. Small ones fill their grains; the longer a border, the harder it is to
/// hide, so the less it is pulled outwards; and less still where it shows more than the photograph's own
/// texels do.
std::vector<InterchangePatch> best_cuts(const LayerSources& sources, const SquareMarks& region,
                                        PatchPlace place, const PlaceSearch::Band& band) {
    const auto unit = static_cast<std::uint32_t>(sources.tile.side * 3 / 32);
    place.pull = sources.gradient * 3 * unit / (static_cast<std::uint32_t>(place.core) + unit);
    auto offsets = sources.places.best(place.x, place.y, place.side, band_of(region, place.side), band, cuts);
    const std::uint32_t most_gradient = sources.gradient * most_gradient_percent / 100;
    const std::size_t most = place.core >= large_core ? most_of_large : most_of_small;
    std::vector<InterchangePatch> best;
    for (int round = 0; round < rounds; ++round) {
        std::vector<InterchangePatch> found;
        for (const auto& at : offsets) {
            place.at = at;
            found.push_back(cut_patch(sources.photo, sources.tile, region, place));
        }
        std::vector<std::size_t> order(found.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::erase_if(order, [&](std::size_t i) { return found[i].texels == 0; });
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return found[a].cost < found[b].cost; });
        if (order.empty()) break;
        best.clear();
        for (const std::size_t i : order)
            if (best.size() < most && as_good(found[i], found[order[0]], most_gradient))
                best.push_back(found[i]);
        if (best[0].gradient <= most_gradient) break;
        // Those that came close get another try
        std::vector<ExchangeAsset::Offset> closest;
        for (const std::size_t i : order)
            if (closest.size() < tried_again) closest.push_back(offsets[i]);
        offsets = std::move(closest);
        place.pull /= 2;
    }
    return best;
}

}  // namespace

std::vector<InterchangePatch> make_layer(const LayerSources& sources, std::int32_t number, std::size_t most) {
    const std::uint64_t key = hash(sources.seed, layer_stream, number, 0);
    Gaps gaps{sources.tile.side};
    std::vector<InterchangePatch> layer;
    for (std::int64_t step = 0; layer.size() < most && !sources.stop.stop_requested(); ++step) {
        const std::uint64_t bits = hash(key, layer_stream, step, 1);
        // Of a size that layers draw, so that they mix sizes in ways of their own, or of one for the gap
        const std::int32_t cap = sources.largest * static_cast<std::int32_t>(16 - bits % 3) / 16;
        const Gaps::Gap gap = gaps.next(cap * 3 / 8, bits);
        if (gap.radius < 1) break;
        PatchPlace place;
        place.core = std::max(8, std::min(gap.radius * 8 / 3 + 4, cap) / 8 * 8);
        place.side = place.core + 2 * sources.margin;
        place.x = gap.x - place.side / 2;
        place.y = gap.y - place.side / 2;
        place.pull = 2 * sources.gradient;
        const GrainSquare square{sources, gaps, place};
        const PlaceSearch::Band band = band_for(sources, bits);

        // The grains that the best place suggests; then the best places for these grains
        const auto first =
            sources.places.best(place.x, place.y, place.side, ring_of(place, square.free), band, 1);
        SquareMarks suggested(square.free.size());
        if (!first.empty()) {
            place.at = first[0];
            suggested = suggested_shape(sources.photo, sources.tile, square.free, place);
        }
        const SquareMarks region = square.whole_grains(suggested);
        std::vector<InterchangePatch> best = best_cuts(sources, region, place, band);
        gaps.take(region, place.x, place.y, place.side);
        gaps.take(gap.x, gap.y);
        for (InterchangePatch& patch : best)
            if (patch.texels >= least_texels) layer.push_back(std::move(patch));
    }
    if (layer.size() > most) layer.resize(most);
    std::stable_sort(layer.begin(), layer.end(), [](const InterchangePatch& a, const InterchangePatch& b) {
        return a.texels > b.texels;
    });
    return layer;
}

}  // namespace tessera
