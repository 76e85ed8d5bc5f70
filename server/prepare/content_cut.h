#pragma once

#include <cstdint>
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
    /// −1 to width, −1 to height.
    const PerceptualColor& tile_at(std::int32_t x, std::int32_t y) const noexcept {
        return tile[static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(width + 2) +
                    static_cast<std::size_t>(x + 1)];
    }
    bool holds(std::int32_t x, std::int32_t y) const noexcept {
        return x >= 0 && y >= 0 && x < width && y < height && depths[index(x, y)] > 0;
    }
};

PatchGround make_patch_ground(const PerceptualImage& tile, const Segmentation& segmentation,
                              std::size_t patch);

/// The shape in which a place of the photograph is best shown on a patch: the cheapest cut between it and the
/// tile, inside the patch; texels deeper than `core` are always in. The cut's price is the sum of what will
/// be seen along it, in color_distance()s, of which only what is beyond `usual` counts in full. (Kwatra et
/// al., "Graphcut textures", ACM TOG 22(3), 2003, sum how the images differ on both sides instead; that a
/// colour meets the like of it is enough, and finds a third less to be seen.) `tile_prices`: for each texel
/// of the box what it costs to leave it to the tile, of any sign. The box at `at` is in the photograph.
BitMask cut_content(const PatchGround& ground, const PerceptualImage& photo, ExchangeAsset::Offset at,
                    std::int32_t core, std::uint32_t usual, const std::vector<std::int32_t>& tile_prices);

/// What is seen along a shape's border: the distances of neighbours on both sides of it.
struct SeamSum {
    std::uint64_t distances = 0;
    std::uint64_t pairs = 0;
};
SeamSum sum_seam(const PatchGround& ground, const PerceptualImage& photo, ExchangeAsset::Offset at,
                 const BitMask& shape);

}  // namespace tessera
