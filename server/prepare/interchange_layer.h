#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "server/prepare/interchange_patch.h"
#include "server/prepare/interchange_places.h"
#include "server/prepare/patches.h"

namespace tessera {

/// What all layers share.
struct LayerSources {
    const PerceptualImage& photo;
    const QuiltedTile& tile;
    const Segmentation& grains;  ///< Of the tile: see make_layer().
    const PlaceSearch& places;
    std::uint32_t gradient = 0;  ///< The photograph's mean step from texel to texel, as distance() has it.
    std::int32_t margin = 0;     ///< About the radius of a grain, a multiple of 4.
    std::int32_t largest = 0;    ///< Core of the largest square, a multiple of 8.
    std::int32_t layers = 1;     ///< How many there will be.
    std::uint64_t seed = 1;
    std::stop_token stop;
};

/// One way to cover the torus with patches that do not overlap: large ones at random places first, then
/// always one where the largest gap is, until none is left. The largest first; at most `most`.
///
/// Shapes that follow the photograph alone leave gaps that no other patch fits, a third of the plane and more
/// however many there are. So the tile is divided into grains with quiet borders, once for all layers, and a
/// patch is cut in a number of whole grains: those that the free cut suggests. What any patches leave is
/// whole grains again, and there are patches for every single one of them.
std::vector<InterchangePatch> make_layer(const LayerSources& sources, std::int32_t number, std::size_t most);

}  // namespace tessera
