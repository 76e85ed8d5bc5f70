#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/perceptual.h"
#include "server/texture/exchange.h"

namespace tessera {

/// A cover of the torus by patches: connected, each in a bounding box of at most half the tile's side.
struct Segmentation {
    std::vector<std::uint16_t> labels;          ///< side×side
    std::vector<ExchangeAsset::Patch> patches;  ///< Boxes; no contents yet.
};

/// Where borders keep to. Along them the tile shows in every period: what is as light as the tile on average
/// repeats without being seen.
enum class BorderPlaces { quiet, quiet_and_of_mean_lightness };

/// Grows about `count` patches on the periodic `tile` (square, a power of two a side), whose borders keep to
/// such places. `count` is from 16 to side²/16.
Segmentation make_patches(const PerceptualImage& tile, std::int32_t count, std::uint64_t seed,
                          BorderPlaces places = BorderPlaces::quiet);

}  // namespace tessera
