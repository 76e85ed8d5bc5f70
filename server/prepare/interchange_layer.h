#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "server/prepare/interchange_patch.h"
#include "server/prepare/interchange_places.h"

namespace tessera {

/// What all layers share.
struct LayerSources {
    const PerceptualImage& photo;
    const QuiltedTile& tile;
    const PlaceSearch& places;
    std::uint32_t pull = 0;    ///< See PatchPlace.
    std::int32_t largest = 0;  ///< Side of the largest square, a multiple of 8.
    std::uint64_t seed = 1;
    std::stop_token stop;
};

/// One way to cover the torus with patches that do not overlap: large ones at random places first, then
/// always one where the largest gap is, cut to fit between the others, down to gaps of a few texels. So the
/// patches of one layer lie close together, and each of them also beside those of other layers. The largest
/// first; at most `most`.
std::vector<InterchangePatch> make_layer(const LayerSources& sources, std::int64_t number, std::size_t most);

}  // namespace tessera
