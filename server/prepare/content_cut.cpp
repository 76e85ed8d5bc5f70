#include "server/prepare/content_cut.h"

#include <algorithm>

#include "server/prepare/graph_cut.h"

namespace tessera {
namespace {

using Offset = ExchangeAsset::Offset;

/// What a border costs where both sides are the patch's own, in quarters, and where it is the patch's own
/// border, on which the neighbours' contents may be met instead of the tile, while these are not known.
constexpr int inner_weight = 4;
constexpr int rim_weight = 6;
/// What is seen beyond twice the usual counts so many times more.
constexpr std::uint32_t hard_edge_weight = 2;

/// The photograph moved onto the box. One texel around the box it may have ended.
class MovedPhoto {
  public:
    MovedPhoto(const PerceptualImage& photo, Offset at) : photo_{photo}, at_{at} {}
    const PerceptualColor& at(std::int32_t x, std::int32_t y) const noexcept {
        return photo_.at(std::clamp(at_.x + x, 0, photo_.width - 1),
                         std::clamp(at_.y + y, 0, photo_.height - 1));
    }

  private:
    const PerceptualImage& photo_;
    Offset at_;
};

/// The grid of a cut, of the box and one texel around it, in the box's coordinates. All prices are doubled,
/// so that they can be halved.
class Cut {
  public:
    Cut(std::int32_t width, std::int32_t height)
        : grid_{width + 2, height + 2}, inside_(grid_.right.size()) {}

    /// A border between two neighbours: its price with the first one inside, and with the second one inside.
    void add_border(std::size_t first, std::size_t second, std::vector<std::uint32_t>& borders,
                    std::uint32_t first_in, std::uint32_t second_in) {
        borders[first] = first_in + second_in;
        inside_[first] += static_cast<std::int32_t>(first_in) - static_cast<std::int32_t>(second_in);
        inside_[second] += static_cast<std::int32_t>(second_in) - static_cast<std::int32_t>(first_in);
    }
    void add_inside(std::size_t texel, std::int32_t price) { inside_[texel] += 2 * price; }
    void force(std::size_t texel, bool in) { (in ? grid_.outside : grid_.inside)[texel] = CutGrid::must; }

    std::vector<std::uint32_t>& right() { return grid_.right; }
    std::vector<std::uint32_t>& below() { return grid_.below; }
    std::size_t index(std::int32_t x, std::int32_t y) const { return grid_.index(x + 1, y + 1); }

    BitMask cheapest() {
        for (std::size_t i = 0; i < inside_.size(); ++i) {
            if (grid_.outside[i] == CutGrid::must || grid_.inside[i] == CutGrid::must) continue;
            (inside_[i] > 0 ? grid_.inside : grid_.outside)[i] =
                static_cast<std::uint32_t>(inside_[i] > 0 ? inside_[i] : -inside_[i]);
        }
        return cheapest_shape(grid_).shape;
    }

  private:
    CutGrid grid_;
    std::vector<std::int32_t> inside_;  ///< What inside costs more than outside.
};

/// All that can be reached from `open` over texels that `passes`, marked in `reached`.
template <class Passes>
void flood(std::vector<std::int32_t> open, std::int32_t width, std::int32_t height,
           std::vector<std::uint8_t>& reached, const Passes& passes) {
    while (!open.empty()) {
        const std::int32_t i = open.back();
        open.pop_back();
        const std::int32_t x = i % width, y = i / width;
        const auto visit = [&](std::int32_t to_x, std::int32_t to_y) {
            if (to_x < 0 || to_y < 0 || to_x >= width || to_y >= height) return;
            const std::int32_t to = to_y * width + to_x;
            if (reached[static_cast<std::size_t>(to)] != 0 || !passes(to_x, to_y)) return;
            reached[static_cast<std::size_t>(to)] = 1;
            open.push_back(to);
        };
        visit(x - 1, y);
        visit(x + 1, y);
        visit(x, y - 1);
        visit(x, y + 1);
    }
}

/// The shape without islands and holes, which show nothing but their seams: what hangs together with texels
/// deeper than `core`.
BitMask without_islands(const PatchGround& ground, const BitMask& shape, std::int32_t core) {
    const auto texels = static_cast<std::size_t>(ground.width) * static_cast<std::size_t>(ground.height);
    std::vector<std::uint8_t> land(texels), sea(texels);
    std::vector<std::int32_t> heart;
    for (std::size_t i = 0; i < texels; ++i)
        if (ground.depths[i] > core) {
            land[i] = 1;
            heart.push_back(static_cast<std::int32_t>(i));
        }
    flood(std::move(heart), ground.width, ground.height, land,
          [&](std::int32_t x, std::int32_t y) { return shape.at(x, y); });
    std::vector<std::int32_t> shore;
    for (std::int32_t y = 0; y < ground.height; ++y)
        for (std::int32_t x = 0; x < ground.width; ++x) {
            const bool edge = x == 0 || y == 0 || x == ground.width - 1 || y == ground.height - 1;
            const std::size_t i = ground.index(x, y);
            if (ground.depths[i] == 0 || (edge && land[i] == 0)) {
                sea[i] = 1;
                shore.push_back(static_cast<std::int32_t>(i));
            }
        }
    flood(std::move(shore), ground.width, ground.height, sea,
          [&](std::int32_t x, std::int32_t y) { return land[ground.index(x, y)] == 0; });
    BitMask out{ground.width, ground.height};
    for (std::int32_t y = 0; y < ground.height; ++y)
        for (std::int32_t x = 0; x < ground.width; ++x)
            if (sea[ground.index(x, y)] == 0) out.set(x, y);
    return out;
}

}  // namespace

PatchGround make_patch_ground(const PerceptualImage& tile, const Segmentation& segmentation,
                              std::size_t patch) {
    const auto& box = segmentation.patches[patch];
    const std::int32_t wrap = tile.width - 1;
    PatchGround ground;
    ground.width = box.width;
    ground.height = box.height;
    for (std::int32_t y = -1; y <= box.height; ++y)
        for (std::int32_t x = -1; x <= box.width; ++x)
            ground.tile.push_back(tile.at((box.x + x) & wrap, (box.y + y) & wrap));

    // Steps to the nearest texel outside, by two sweeps
    ground.depths.resize(static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height));
    const auto depth = [&](std::int32_t x, std::int32_t y) {
        return ground.holds(x, y) ? ground.depths[ground.index(x, y)] : std::int16_t{0};
    };
    for (std::int32_t y = 0; y < box.height; ++y)
        for (std::int32_t x = 0; x < box.width; ++x) {
            const auto texel =
                static_cast<std::size_t>(((box.y + y) & wrap) * tile.width + ((box.x + x) & wrap));
            if (segmentation.labels[texel] == patch)
                ground.depths[ground.index(x, y)] =
                    static_cast<std::int16_t>(1 + std::min(depth(x - 1, y), depth(x, y - 1)));
        }
    for (std::int32_t y = box.height - 1; y >= 0; --y)
        for (std::int32_t x = box.width - 1; x >= 0; --x)
            if (std::int16_t& own = ground.depths[ground.index(x, y)]; own > 0) {
                own =
                    std::min(own, static_cast<std::int16_t>(1 + std::min(depth(x + 1, y), depth(x, y + 1))));
                ground.deepest = std::max(ground.deepest, own);
            }
    return ground;
}

BitMask cut_content(const PatchGround& ground, const PerceptualImage& photo, Offset at, std::int32_t core,
                    std::uint32_t usual, const std::vector<std::int32_t>& tile_prices,
                    const ColorsBeside& beside) {
    const MovedPhoto moved{photo, at};
    const std::int32_t width = ground.width, height = ground.height;
    // What is in at every price: the core, which is never empty
    const std::int32_t deep = std::min<std::int32_t>(core, ground.deepest - 1);
    const auto in_core = [&](std::int32_t x, std::int32_t y) {
        return ground.holds(x, y) && ground.depths[ground.index(x, y)] > deep;
    };

    Cut cut{width, height};

    // What is usual in the photograph is not seen along a border either: only what is beyond it counts, and
    // a long border in quiet places costs nothing
    const auto price = [&](const PerceptualColor& a, const PerceptualColor& b) {
        const std::uint32_t seen = color_distance(a, b);
        return (seen > usual ? seen - usual : 0) +
               (seen > 2 * usual ? hard_edge_weight * (seen - 2 * usual) : 0);
    };
    // Along the patch's own border: inside it meets the content, else the tile, which meets itself as usual
    const auto add_rim = [&](std::int32_t x, std::int32_t y, const PerceptualColor& tile_beside,
                             const std::vector<PerceptualColor>& others) {
        std::int64_t content = 0, tile = 0;
        for (const PerceptualColor& other : others) {
            content += price(moved.at(x, y), other);
            if (other != tile_beside) tile += price(ground.tile_at(x, y), other);
        }
        const std::int64_t count = std::ssize(others);
        cut.add_inside(cut.index(x, y), static_cast<std::int32_t>(content / count - tile / count));
    };
    const auto add = [&](std::int32_t x, std::int32_t y, std::int32_t to_x, std::int32_t to_y,
                         std::vector<std::uint32_t>& borders) {
        const bool here = ground.holds(x, y), there = ground.holds(to_x, to_y);
        if ((!here && !there) || (in_core(x, y) && in_core(to_x, to_y))) return;
        if (here != there && !beside.empty()) {
            const std::size_t outside = here ? ground.index_around(to_x, to_y) : ground.index_around(x, y);
            return add_rim(here ? x : to_x, here ? y : to_y, ground.tile[outside], beside.at(outside));
        }
        const auto weight = static_cast<std::uint32_t>(here && there ? inner_weight : rim_weight);
        const std::size_t first = cut.index(x, y), second = cut.index(to_x, to_y);
        cut.add_border(first, second, borders,
                       here ? weight * price(moved.at(x, y), ground.tile_at(to_x, to_y)) / inner_weight : 0,
                       there ? weight * price(ground.tile_at(x, y), moved.at(to_x, to_y)) / inner_weight : 0);
    };
    for (std::int32_t y = -1; y <= height; ++y)
        for (std::int32_t x = -1; x <= width; ++x) {
            if (x < width) add(x, y, x + 1, y, cut.right());
            if (y < height) add(x, y, x, y + 1, cut.below());
            if (!ground.holds(x, y))
                cut.force(cut.index(x, y), false);
            else if (in_core(x, y))
                cut.force(cut.index(x, y), true);
            else
                cut.add_inside(cut.index(x, y), -tile_prices[ground.index(x, y)]);
        }
    const BitMask around = cut.cheapest();
    BitMask shape{width, height};
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x)
            if (around.at(x + 1, y + 1)) shape.set(x, y);
    return without_islands(ground, shape, deep);
}

SeamSum sum_seam(const PatchGround& ground, const PerceptualImage& photo, Offset at, const BitMask& shape) {
    const MovedPhoto moved{photo, at};
    SeamSum sum;
    for (std::int32_t y = 0; y < ground.height; ++y)
        for (std::int32_t x = 0; x < ground.width; ++x) {
            if (!shape.at(x, y)) continue;
            const auto compare = [&](std::int32_t to_x, std::int32_t to_y) {
                if (to_x >= 0 && to_y >= 0 && to_x < ground.width && to_y < ground.height &&
                    shape.at(to_x, to_y))
                    return;
                sum.distances += color_distance(moved.at(x, y), ground.tile_at(to_x, to_y));
                ++sum.pairs;
            };
            compare(x - 1, y);
            compare(x + 1, y);
            compare(x, y - 1);
            compare(x, y + 1);
        }
    return sum;
}

}  // namespace tessera
