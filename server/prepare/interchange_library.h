#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/prepare/interchange_patch.h"
#include "server/prepare/perceptual.h"
#include "server/prepare/quilting.h"
#include "server/progress/progress.h"

namespace tessera {

struct LibrarySearch {
    std::int32_t patches = 1200;  ///< Wanted.
    std::int32_t blend_texels = 4;
    std::uint64_t seed = 1;
    std::size_t threads = 1;
    std::vector<InterchangePatch> given;     ///< Part of the library already.
    std::vector<InterchangePatch> unwanted;  ///< Not to be found again.
};

/// Patches of many sizes all over the tile, its borders and corners included, layer by layer. The
/// worst of each size by their highest price are left out; no two that overlap show the photograph displaced
/// alike. Without the given ones. Empty if stopped.
std::vector<InterchangePatch> find_library(const PerceptualImage& photo, const QuiltedTile& tile,
                                           const LibrarySearch& search, Progress& progress);

}  // namespace tessera
