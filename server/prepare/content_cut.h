#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "server/prepare/patches.h"
#include "server/prepare/perceptual.h"
#include "server/texture/exchange_asset.h"

namespace tessera {

/// A patch and the tile around it, as cuts see them.
struct PatchGround {
    std::int32_t width = 0, height = 0;  ///< Of the patch's box.
    std::vector<std::int16_t>
        depths;  ///< Of the box's texels: steps to the nearest texel outside the patch; 0 is outside.
    std::int16_t deepest = 0;
    std::vector<PerceptualColor> tile;  ///< (width + 2) × (height + 2): the box and one texel around it.

    std::size_t index(std::int32_t x, std::int32_t y) const noexcept {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    /// Of the box and one texel around it: −1 to width, −1 to height.
    std::size_t index_around(std::int32_t x, std::int32_t y) const noexcept {
        return static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(width + 2) +
               static_cast<std::size_t>(x + 1);
    }
    const PerceptualColor& tile_at(std::int32_t x, std::int32_t y) const noexcept {
        return tile[index_around(x, y)];
    }
    bool holds(std::int32_t x, std::int32_t y) const noexcept {
        return x >= 0 && y >= 0 && x < width && y < height && depths[index(x, y)] > 0;
    }
};

PatchGround make_patch_ground(const PerceptualImage& tile, const Segmentation& segmentation,
                              std::size_t patch);

/// What texels beside a patch show, by index_around(): the colours of the tile and of all contents of the
/// patch that holds them, each of which is shown equally often.
using ColorsBeside = std::unordered_map<std::size_t, std::vector<PerceptualColor>>;

/// The shape in which a place of the photograph is best shown on a patch: the cheapest cut between it and the
/// tile, inside the patch; texels deeper than `core` are always in. The cut's price is the sum of what will
/// be seen along it, in color_distance()s, of which only what is beyond `usual` counts, and what is
/// beyond twice that threefold: few hard edges are seen more than many weak ones. (Kwatra et
/// al., "Graphcut textures", ACM TOG 22(3), 2003, sum how the images differ on both sides instead; that a
/// colour meets the like of it is enough, and finds a third less to be seen.) `tile_prices`: for each texel
/// of the box what it costs to leave it to the tile, of any sign. `beside`: what the patch's neighbours show,
/// for every texel outside it that touches it; along the patch's own border the price is the mean over that,
/// both of what the content and of what the tile meets there. Empty while it is not known. The box at `at` is
/// in the photograph.
BitMask cut_content(const PatchGround& ground, const PerceptualImage& photo, ExchangeAsset::Offset at,
                    std::int32_t core, std::uint32_t usual, const std::vector<std::int32_t>& tile_prices,
                    const ColorsBeside& beside);

/// What is seen along a shape's border: the distances of neighbours on both sides of it.
struct SeamSum {
    std::uint64_t distances = 0;
    std::uint64_t pairs = 0;
};
SeamSum sum_seam(const PatchGround& ground, const PerceptualImage& photo, ExchangeAsset::Offset at,
                 const BitMask& shape);

}  // namespace tessera
