#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "server/prepare/interchange_patch.h"
#include "server/prepare/interchange_places.h"
#include "server/prepare/patches.h"

namespace tessera {

/// What layers are made from.
struct LayerSources {
    const PerceptualImage& photo;
    const QuiltedTile& tile;
    const Segmentation& grains;  ///< Of the tile, this layer's own: see make_layer().
    const PlaceSearch& places;
    std::uint32_t gradient = 0;  ///< The photograph's mean step from texel to texel, as distance() has it.
    std::int32_t margin = 0;     ///< About the radius of a grain, a multiple of 4.
    std::int32_t largest = 0;    ///< Core of the largest square, a multiple of 8.
    std::uint64_t seed = 1;
    std::stop_token stop;
};

/// One way to cover the torus with regions that do not overlap, and for each region some patches: large ones
/// at random places first, then always one where the largest gap is, until none is left. The largest first;
/// at most `most`.
///
/// The tile is divided into grains with quiet borders, and a region is a number of whole grains: those that a
/// free cut suggests. What other regions leave is whole grains again. Every layer has grains of its own,
/// since along their borders the tile is left in sight: those of one layer lie inside the grains of others.
std::vector<InterchangePatch> make_layer(const LayerSources& sources, std::int32_t number, std::size_t most);

}  // namespace tessera
