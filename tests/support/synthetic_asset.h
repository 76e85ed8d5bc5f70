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
    int constant_code = -1;  ///< 0 to 255: every texel of exemplar and tile has this code.
};

/// An asset of noise: Voronoi patches around jittered seeds on the torus, several of which wrap, and contents
/// at random places. Strong contrast, so that a wrong texel is far off.
ExchangeAsset make_synthetic_asset(const SyntheticAssetOptions& options);

}  // namespace tessera::tests
