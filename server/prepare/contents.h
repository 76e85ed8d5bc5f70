#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/patches.h"
#include "server/prepare/perceptual.h"
#include "server/prepare/progress.h"
#include "server/prepare/tile.h"

namespace tessera {

struct ContentSearch {
    std::int32_t contents = 24;     ///< Wanted for each patch.
    std::int32_t blend_texels = 8;  ///< Even.
    std::size_t threads = 1;
};

/// What was found for one patch.
struct FoundContents {
    std::vector<ContentExchangeAsset::Offset> offsets;  ///< The best first.
    std::vector<std::uint64_t> costs;  ///< Of each, the mean difference() along the patch's border.
};

/// For each patch the translations into the photograph that fit it best along its border. They lie apart from
/// one another and from where the tile itself was cut, and the patch's box with half the blending width
/// around it lies inside the photograph. Fewer than wanted where the photograph holds no more.
std::vector<FoundContents> find_contents(const PerceptualImage& photo, const PerceptualImage& tile_colors,
                                         const PeriodicTile& tile, const Segmentation& segmentation,
                                         const ContentSearch& search, Progress& progress);

}  // namespace tessera
