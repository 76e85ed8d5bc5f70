#include "server/prepare/interchange_group.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <tuple>

#include "server/prepare/graph_cut.h"
#include "server/prepare/seam.h"
#include "server/prepare/tile.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

constexpr std::uint64_t window_stream = stream("group window");

/// What a texel shows: the number of a patch, or one of these.
enum Shows : std::int32_t { fixed_tile = -3, tile_rim = -2, nothing = -1 };

/// How many of the best places are cut, and how many are compared texel by texel.
constexpr std::size_t most_cuts = 2, most_kept = 24;

struct Place {
    std::uint64_t misfit = 0;
    PhotoPoint at;
    bool operator<(const Place& other) const {
        return std::tuple{misfit, at.y, at.x} < std::tuple{other.misfit, other.at.y, other.at.x};
    }
};

/// A square of the region that one patch is cut for, and the part of it that is to be filled.
struct Block {
    std::int32_t x = 0, y = 0, side = 0;
};

class Filling {
  public:
    Filling(const GroupSources& sources, const PatchRegion& region) : sources_{sources}, region_{region} {
        const std::int32_t side = region.side;
        const std::vector<std::int32_t> depth = depths(region.inside, side);
        // Cuts have this much room along the border
        rim_ = 3 * std::clamp(sources.largest / 8, 4, 16);
        shows_.resize(depth.size());
        depths_ = depth;
        colors_.reserve(depth.size());
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x) {
                const std::size_t i = index(x, y);
                shows_[i] = depth[i] == 0 ? fixed_tile : depth[i] <= rim_ ? tile_rim : nothing;
                colors_.push_back(sources.tile.color(region.x + x, region.y + y));
            }
    }

    void fill(std::uint64_t bits) {
        const std::int32_t side = region_.side;
        const std::int32_t overlap = std::max(4, sources_.largest / 6);
        const std::int32_t step = std::max(4, sources_.largest - 2 * overlap);
        const auto skew = [&](std::uint64_t part) {
            return static_cast<std::int32_t>(
                uniform_below(hash(bits, window_stream, static_cast<std::int64_t>(part), 1),
                              static_cast<std::uint32_t>(step)));
        };
        std::int64_t number = 0;
        std::int32_t row = 0;
        for (std::int32_t top = -skew(0); top < side; top += step, ++row)
            for (std::int32_t left = -skew(static_cast<std::uint64_t>(row) + 1); left < side; left += step) {
                if (!has_nothing(left, top, step)) continue;
                // Blocks may be moved to lie in the square, which holds the region and some texels around it
                const std::int32_t block_side = std::min(step + 2 * overlap, side);
                const Block block{std::clamp(left - overlap, 0, side - block_side),
                                  std::clamp(top - overlap, 0, side - block_side), block_side};
                lay_cheapest(block, hash(bits, window_stream, number++, 0));
            }
    }

    InterchangeGroup patches() const {
        InterchangeGroup group;
        const std::int32_t side = region_.side;
        struct Box {
            std::int32_t left = INT32_MAX, top = INT32_MAX, right = 0, bottom = 0, texels = 0;
        };
        std::vector<Box> boxes(displacements_.size());
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x) {
                const std::int32_t shown = shows_[index(x, y)];
                if (shown < 0) continue;
                Box& box = boxes[static_cast<std::size_t>(shown)];
                box.left = std::min(box.left, x), box.right = std::max(box.right, x + 1);
                box.top = std::min(box.top, y), box.bottom = std::max(box.bottom, y + 1);
                ++box.texels;
            }
        for (std::size_t p = 0; p < boxes.size(); ++p) {
            const Box& box = boxes[p];
            if (box.texels == 0) continue;
            InterchangePatch patch;
            patch.x = region_.x + box.left, patch.y = region_.y + box.top;
            patch.width = box.right - box.left, patch.height = box.bottom - box.top;
            patch.at = {displacements_[p].x + box.left, displacements_[p].y + box.top};
            patch.texels = box.texels;
            patch.in_rhombus = false;
            patch.shape = BitMask{patch.width, patch.height};
            for (std::int32_t y = box.top; y < box.bottom; ++y)
                for (std::int32_t x = box.left; x < box.right; ++x)
                    if (shows_[index(x, y)] == static_cast<std::int32_t>(p))
                        patch.shape.set(x - box.left, y - box.top);
            group.patches.push_back(std::move(patch));
        }
        return group;
    }

  private:
    std::size_t index(std::int32_t x, std::int32_t y) const noexcept {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(region_.side) +
               static_cast<std::size_t>(x);
    }

    bool has_nothing(std::int32_t left, std::int32_t top, std::int32_t step) const {
        const std::int32_t side = region_.side;
        for (std::int32_t y = std::max(0, top); y < std::min(side, top + step); ++y)
            for (std::int32_t x = std::max(0, left); x < std::min(side, left + step); ++x)
                if (shows_[index(x, y)] == nothing) return true;
        return false;
    }

    /// Texels that a patch must match: those that it may take, every `stride`-th, rows set off.
    struct Known {
        std::int32_t x = 0, y = 0;
        PerceptualColor color;
    };
    std::vector<Known> known_texels(const Block& block, std::int32_t stride) const {
        std::vector<Known> known;
        for (std::int32_t y = 0; y < block.side; y += stride)
            for (std::int32_t x = (y / stride % 2) * (stride / 2); x < block.side; x += stride) {
                const std::size_t i = index(block.x + x, block.y + y);
                if (shows_[i] == tile_rim || shows_[i] >= 0) known.push_back({x, y, colors_[i]});
            }
        return known;
    }
    std::uint64_t misfit(const std::vector<Known>& known, PhotoPoint at) const {
        std::uint64_t sum = 0;
        for (const Known& texel : known)
            sum += static_cast<std::uint64_t>(
                difference(texel.color, sources_.photo.at(at.x + texel.x, at.y + texel.y)));
        return sum;
    }

    /// Places of the photograph that show there what the tile shows: displacements, the block's first texel.
    std::vector<PhotoPoint> places_of_tile(const Block& block) const {
        constexpr std::int32_t samples = 8, seldom = 4;
        std::map<std::pair<std::int32_t, std::int32_t>, int> counts;
        for (std::int32_t i = 0; i < samples * samples; ++i) {
            const std::int32_t u = block.side * (2 * (i % samples) + 1) / (2 * samples);
            const std::int32_t v = block.side * (2 * (i / samples) + 1) / (2 * samples);
            const PhotoPoint from = sources_.tile.source(region_.x + block.x + u, region_.y + block.y + v);
            ++counts[{from.x - u, from.y - v}];
        }
        std::vector<PhotoPoint> places;
        for (const auto& [at, count] : counts)
            if (count >= seldom) places.push_back({at.first, at.second});
        return places;
    }

    /// How much of what a block would show from there the group shows already, in 64ths: more than 64 if more
    /// than once.
    std::uint64_t shown_already(const Block& block, PhotoPoint at) const {
        std::int64_t sum = 0;
        for (const PhotoPoint other : laid_from_) {
            const std::int64_t across = block.side - std::abs(other.x - at.x);
            const std::int64_t down = block.side - std::abs(other.y - at.y);
            if (across > 0 && down > 0) sum += 64 * across * down / (std::int64_t{block.side} * block.side);
        }
        return static_cast<std::uint64_t>(sum);
    }

    /// The best places of some at random, so that what must fit alike is not alike.
    std::vector<PhotoPoint> best_places(const Block& block, std::uint64_t bits) const {
        const std::int32_t margin = sources_.margin;
        const std::int32_t across = sources_.photo.width - block.side - 2 * margin + 1;
        const std::int32_t down = sources_.photo.height - block.side - 2 * margin + 1;
        const std::int32_t width = (across * 3 + 4) / 5, height = (down * 3 + 4) / 5;
        const std::int32_t left = margin + static_cast<std::int32_t>(uniform_below(
                                               bits, static_cast<std::uint32_t>(across - width + 1)));
        const std::int32_t top = margin + static_cast<std::int32_t>(uniform_below(
                                              mix(bits), static_cast<std::uint32_t>(down - height + 1)));
        const std::vector<PhotoPoint> tile_places = places_of_tile(block);
        const std::int32_t apart = std::max(4, block.side / 6);
        const auto shows_the_tile = [&](PhotoPoint at) {
            return std::any_of(tile_places.begin(), tile_places.end(), [&](PhotoPoint of_tile) {
                return std::max(std::abs(of_tile.x - at.x), std::abs(of_tile.y - at.y)) < apart;
            });
        };
        std::int32_t step = 1;
        while (step < 8 && block.side / step > 24) step *= 2;
        std::vector<Place> places;
        const std::vector<Known> sparse = known_texels(block, 2 * step);
        for (const bool any : {false, true}) {
            for (std::int32_t y = 0; y < height; y += step)
                for (std::int32_t x = 0; x < width; x += step) {
                    const PhotoPoint at{left + x, top + y};
                    if (!any && shows_the_tile(at)) continue;
                    places.push_back({misfit(sparse, at) / 128 * (128 + shown_already(block, at)), at});
                }
            if (!places.empty()) break;
        }
        const std::size_t kept = std::min(places.size(), most_kept);
        std::partial_sort(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(kept), places.end());
        places.resize(kept);
        // From here on without it, and in the end with it again
        do {
            step = std::max(1, step / 2);
            const std::vector<Known> known = known_texels(block, step);
            for (Place& place : places) {
                const PhotoPoint centre = place.at;
                place.misfit = misfit(known, centre);
                for (std::int32_t i = 0; i < 9; ++i) {
                    const PhotoPoint at{centre.x + (i % 3 - 1) * step, centre.y + (i / 3 - 1) * step};
                    if (at.x < margin || at.y < margin || at.x >= margin + across || at.y >= margin + down)
                        continue;
                    place = std::min(place, Place{misfit(known, at), at});
                }
            }
        } while (step > 1);
        for (Place& place : places)
            place.misfit = place.misfit / 128 * (128 + shown_already(block, place.at));
        std::sort(places.begin(), places.end());
        std::vector<PhotoPoint> best;
        for (const Place& place : places)
            if (best.size() < most_cuts && std::find(best.begin(), best.end(), place.at) == best.end())
                best.push_back(place.at);
        return best;
    }

    /// What a border shows: little below the photograph's own steps, and the more the further above, so that
    /// cuts go round rather than across what would be seen. At most 2^24.
    std::uint32_t shown(std::uint32_t price) const {
        const std::uint64_t usual =
            4 * std::uint64_t{sources_.gradient};  // a price is a sum of four distances
        return static_cast<std::uint32_t>(
            std::min(std::uint64_t{price} * price / usual + 1, std::uint64_t{1} << 24));
    }

    ShapeCut cut(const Block& block, PhotoPoint at) const {
        CutGrid grid{block.side, block.side};
        const auto price = [&](std::int32_t x, std::int32_t y, std::int32_t u,
                               std::int32_t v) -> std::uint32_t {
            const std::size_t s = index(block.x + x, block.y + y), t = index(block.x + u, block.y + v);
            const bool empty_s = shows_[s] == nothing, empty_t = shows_[t] == nothing;
            if (empty_s && empty_t) return 0;
            const PerceptualColor a_s = sources_.photo.at(at.x + x, at.y + y),
                                  a_t = sources_.photo.at(at.x + u, at.y + v);
            const PerceptualColor b_s = colors_[s], b_t = colors_[t];
            if (!empty_s && !empty_t) return shown(seam_price(a_s, a_t, b_s, b_t));
            // Seen from one side only
            return shown(empty_t ? 2 * distance(b_s, a_t) + 2 * distance(a_s, b_s) + 1
                                 : 2 * distance(a_s, b_t) + 2 * distance(a_t, b_t) + 1);
        };
        // What a texel near the border pays for showing the tile
        const std::uint32_t pull = sources_.gradient / 2;
        for (std::int32_t y = 0; y < block.side; ++y)
            for (std::int32_t x = 0; x < block.side; ++x) {
                const std::size_t i = grid.index(x, y), here = index(block.x + x, block.y + y);
                const std::int32_t shows = shows_[here];
                const bool on_rim = x == 0 || y == 0 || x == block.side - 1 || y == block.side - 1;
                if (shows == nothing)
                    grid.outside[i] = CutGrid::must;
                else if (on_rim || shows == fixed_tile)
                    grid.inside[i] = CutGrid::must;
                else if (shows == tile_rim)
                    grid.outside[i] = pull * static_cast<std::uint32_t>(std::min(depths_[here], 24)) / 12;
                if (x + 1 < block.side) grid.right[i] = price(x, y, x + 1, y);
                if (y + 1 < block.side) grid.below[i] = price(x, y, x, y + 1);
            }
        return cheapest_shape(grid);
    }

    void lay_cheapest(const Block& block, std::uint64_t bits) {
        ShapeCut cheapest;
        PhotoPoint from;
        for (const PhotoPoint at : best_places(block, bits)) {
            ShapeCut tried = cut(block, at);
            if (cheapest.shape.width != 0 && tried.cost >= cheapest.cost) continue;
            cheapest = std::move(tried);
            from = at;
        }
        const auto number = static_cast<std::int32_t>(displacements_.size());
        displacements_.push_back({from.x - block.x, from.y - block.y});
        laid_from_.push_back(from);
        for (std::int32_t y = 0; y < block.side; ++y)
            for (std::int32_t x = 0; x < block.side; ++x)
                if (cheapest.shape.at(x, y)) {
                    const std::size_t i = index(block.x + x, block.y + y);
                    shows_[i] = number;
                    colors_[i] = sources_.photo.at(from.x + x, from.y + y);
                }
    }

    const GroupSources& sources_;
    const PatchRegion& region_;
    std::int32_t rim_ = 0;
    std::vector<std::int32_t> depths_, shows_;
    std::vector<PerceptualColor> colors_;
    std::vector<PhotoPoint> laid_from_;      ///< Of each block.
    std::vector<PhotoPoint> displacements_;  ///< Of patches: what the square's first texel would show.
};

}  // namespace

InterchangeGroup fill_region(const GroupSources& sources, const PatchRegion& region, std::uint64_t bits) {
    Filling filling{sources, region};
    filling.fill(bits);
    return filling.patches();
}

}  // namespace tessera
