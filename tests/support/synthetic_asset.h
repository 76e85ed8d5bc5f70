#pragma once

#include <cstdint>

#include "server/texture/exchange.h"

namespace tessera::tests {

struct SyntheticAssetOptions {
    std::int32_t tile_side = 64;
    std::int32_t patches = 12;
    std::int32_t contents = 5;
    std::int32_t blend_texels = 4;
    std::uint64_t seed = 1;
    std::int32_t groups = 0;  ///< Of interchangeable patches, beside those that are shown alone.
    int constant_code = -1;   ///< 0 to 255: every texel of exemplar and tile has this code.
};

/// The part of a patch's box that the patch map gives to it.
BitMask region_of_patch(const ExchangeAsset& asset, std::size_t patch);

/// An asset of noise: Voronoi patches around jittered seeds on the torus, several of which wrap, and contents
/// at random places. Contents have shapes of their own: every other one leaves texels of its patch to the
/// tile. Strong contrast, so that a wrong texel is far off.
ExchangeAsset make_synthetic_asset(const SyntheticAssetOptions& options);

/// Discs and bars of many sizes all over the tile and its borders, in the rhombus; sets a and b by their
/// place. `patches`: about so many; `contents` is not used. Groups are of nine rectangles that fill up to two
/// tiles each way.
ExchangeAsset make_synthetic_interchange(const SyntheticAssetOptions& options);

/// Corner-coloured tiles of noise, two colours; only the tile side, the seed and the constant code are used.
ExchangeAsset make_synthetic_wang(const SyntheticAssetOptions& options);

}  // namespace tessera::tests
