#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/interchange_patch.h"
#include "server/prepare/perceptual.h"
#include "server/prepare/quilting.h"

namespace tessera {

/// Patches that are shown together: cut against each other, and only around all of them against the tile.
struct InterchangeGroup {
    std::vector<InterchangePatch> patches;  ///< Without overlaps; placed as PatchRegion is.
};

/// Where a group may lie: a square of the plane that the tile covers with one copy at (0, 0), and marks for
/// the texels that it may take.
struct PatchRegion {
    std::int32_t x = 0, y = 0, side = 0;
    SquareMarks inside;  ///< None on the rim.
};

/// What groups are made from.
struct GroupSources {
    const PerceptualImage& photo;
    const QuiltedTile& tile;
    std::uint32_t gradient = 0;  ///< The photograph's mean step from texel to texel, as distance() has it.
    std::int32_t margin = 0;     ///< That patches keep from the photograph's border.
    std::int32_t largest = 0;    ///< Side of the largest patch, at least 16.
};

/// Fills a region with patches of the photograph, laid row by row where they fit what lies there already, and
/// divided from it by minimum cuts (Kwatra et al., "Graphcut textures: image and video synthesis using graph
/// cuts", SIGGRAPH 2003, with the tile around instead of nothing). No texel deep inside shows the tile. Other
/// `bits`, other patches.
InterchangeGroup fill_region(const GroupSources& sources, const PatchRegion& region, std::uint64_t bits);

}  // namespace tessera
