#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/prepare/interchange_group.h"
#include "server/prepare/perceptual.h"
#include "server/prepare/quilting.h"
#include "server/progress/progress.h"

namespace tessera {

struct GroupSearch {
    std::int32_t alone = 0;  ///< How many patches that are shown alone the asset has beside.
    std::int32_t blend_texels = 4;
    std::uint64_t seed = 1;
    std::size_t threads = 1;
    std::vector<InterchangeGroup> given;     ///< There already.
    std::vector<InterchangeGroup> unwanted;  ///< Not to be found again.
};

/// Groups of patches that fill units of tiles (server/texture/unit_outline.h). Each layer of them divides the
/// unit in its own way, and there are several groups for each of its parts: as many as the photograph can
/// feed. Without the given ones. Empty if stopped, if the photograph is too small for more than single
/// patches, or if the tile is so large that a unit has no period to hide.
std::vector<InterchangeGroup> find_groups(const PerceptualImage& photo, const QuiltedTile& tile,
                                          const GroupSearch& search, Progress& progress);

}  // namespace tessera
