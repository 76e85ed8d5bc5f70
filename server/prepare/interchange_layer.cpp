#include "server/prepare/interchange_layer.h"

#include <algorithm>
#include <cstdlib>

#include "shared/math/hash.h"

namespace tessera {
namespace {

constexpr std::uint64_t layer_stream = stream("interchange layer");

/// What may be spent on each place of the tile: windows of the photograph, and cuts in each.
constexpr std::int64_t windows = 3;
constexpr std::size_t cuts = 1;

/// The least distance from the middle of a gap to what lies around it, in texels, that a patch is made for.
constexpr std::int32_t least_gap = 4;

/// What of the torus is taken, and how far from it each place is. Kept at a reduced size for large tiles.
class Gaps {
  public:
    explicit Gaps(std::int32_t side)
        : side_{side},
          factor_{std::max(1, side / 256)},
          cells_{side / factor_},
          taken_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side)),
          distances_(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_), far) {}

    const std::vector<std::uint8_t>& taken() const noexcept { return taken_; }

    void take(const InterchangePatch& patch) {
        for (std::int32_t y = 0; y < patch.height; ++y)
            for (std::int32_t x = 0; x < patch.width; ++x)
                if (patch.shape.at(x, y)) {
                    const std::int32_t u = (patch.x + x) & (side_ - 1), v = (patch.y + y) & (side_ - 1);
                    taken_[static_cast<std::size_t>(v * side_ + u)] = 1;
                    distances_[cell(u / factor_, v / factor_)] = 0;
                }
        measure();
    }
    /// No gap is looked for at this place any more.
    void give_up(std::int32_t x, std::int32_t y) {
        distances_[cell(x / factor_, y / factor_)] = 0;
        measure();
    }

    struct Gap {
        std::int32_t x = 0, y = 0, radius = 0;  ///< In texels.
    };
    /// The largest gap, give or take a quarter by `bits`.
    Gap largest(std::uint64_t bits) const {
        Gap best;
        std::int64_t most = -1;
        for (std::int32_t y = 0; y < cells_; ++y)
            for (std::int32_t x = 0; x < cells_; ++x) {
                const std::int32_t distance = distances_[cell(x, y)];
                if (distance == 0) continue;
                const std::int64_t jitter =
                    192 + static_cast<std::int64_t>(hash(bits, layer_stream, x, y) >> 58);
                if (distance * jitter <= most) continue;
                most = distance * jitter;
                best = {x * factor_ + factor_ / 2, y * factor_ + factor_ / 2, distance * factor_ / 3};
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

/// A part of the photograph to look in: what comes from everywhere differs, and takes less time. Small
/// squares find enough in small windows.
PlaceSearch::Window window_at(const PlaceSearch::Window& all, std::int32_t side, std::uint64_t bits) {
    const std::int32_t most = side * 16;
    PlaceSearch::Window window{0, 0, std::clamp(all.width / 2, 1, most), std::clamp(all.height / 2, 1, most)};
    window.left = all.left + static_cast<std::int32_t>(uniform_below(
                                 bits, static_cast<std::uint32_t>(all.width - window.width + 1)));
    window.top = all.top + static_cast<std::int32_t>(uniform_below(
                               mix(bits), static_cast<std::uint32_t>(all.height - window.height + 1)));
    return window;
}

}  // namespace

std::vector<InterchangePatch> make_layer(const LayerSources& sources, std::int64_t number, std::size_t most) {
    const std::int32_t tile_side = sources.tile.side;
    const std::uint64_t key = hash(sources.seed, layer_stream, number, 0);
    Gaps gaps{tile_side};
    std::vector<InterchangePatch> layer;
    for (std::int64_t step = 0; layer.size() < most && !sources.stop.stop_requested(); ++step) {
        const std::uint64_t bits = hash(key, layer_stream, step, 1);
        const Gaps::Gap gap = gaps.largest(bits);
        if (gap.radius < least_gap) break;

        // Of a size for the gap: the bell reaches somewhat beyond it, so that nooks are filled too; smaller
        // than that at random, so that layers mix sizes in ways of their own
        const std::int32_t cap = sources.largest * static_cast<std::int32_t>(16 - bits % 9) / 16;
        PatchPlace place;
        place.side = std::max(8, std::min(gap.radius * 7 / 2 + 7, cap) / 8 * 8);
        place.x = gap.x - place.side / 2;
        place.y = gap.y - place.side / 2;
        place.pull = sources.pull;
        // Close to the tile's corner the rhombus would leave half a patch: it may lie across, in neither set
        const std::int32_t depth =
            tile_side - std::abs(gap.x - tile_side / 2) - std::abs(gap.y - tile_side / 2);
        place.in_rhombus = depth >= place.side / 2;

        InterchangePatch best;
        const PlaceSearch::Window all = sources.places.everywhere(place.side);
        for (std::int64_t w = 0; w < windows; ++w) {
            const auto window = window_at(all, place.side, hash(bits, layer_stream, w, 2));
            for (const auto& at :
                 sources.places.best(place.x, place.y, place.side, gaps.taken(), window, cuts)) {
                place.at = at;
                InterchangePatch patch = cut_patch(sources.photo, sources.tile, gaps.taken(), place);
                if (patch.texels > 0 && (best.texels == 0 || patch.cost < best.cost)) best = std::move(patch);
            }
        }
        if (best.texels == 0) {
            gaps.give_up(gap.x, gap.y);
            continue;
        }
        gaps.take(best);
        layer.push_back(std::move(best));
    }
    std::stable_sort(layer.begin(), layer.end(), [](const InterchangePatch& a, const InterchangePatch& b) {
        return a.texels > b.texels;
    });
    return layer;
}

}  // namespace tessera
