#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/content_choice.h"
#include "server/prepare/patches.h"
#include "server/prepare/perceptual.h"
#include "server/prepare/tile.h"
#include "server/progress/progress.h"

namespace tessera {

struct ContentSearch {
    std::int32_t contents = 24;     ///< Wanted for each patch.
    std::int32_t blend_texels = 8;  ///< Even.
    std::size_t threads = 1;
};

/// For each patch the translations into the photograph that fit it best along its border. They lie apart from
/// one another and from where the tile itself was cut, and the patch's box with half the blending width
/// around it lies inside the photograph. Together they show all of the
/// photograph about equally often. The best fit comes first; fewer than wanted where the photograph holds no
/// more.
std::vector<std::vector<ShapedContent>> find_contents(const PerceptualImage& photo,
                                                      const PerceptualImage& tile_colors,
                                                      const PeriodicTile& tile,
                                                      const Segmentation& segmentation,
                                                      const ContentSearch& search, Progress& progress);

}  // namespace tessera
