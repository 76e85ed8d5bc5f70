#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "server/prepare/candidates.h"
#include "server/prepare/patches.h"
#include "server/prepare/perceptual.h"
#include "server/prepare/tile.h"
#include "server/progress/progress.h"

namespace tessera {

struct CandidateSearch {
    std::size_t wanted = 48;        ///< Of each patch.
    std::int32_t blend_texels = 8;  ///< Even.
    std::size_t threads = 1;
    std::function<void(double)> advance = [](double) {};  ///< Told the fraction done, from any thread.
};

/// How far apart two contents of a patch are at least.
std::int32_t distinct_distance(const ExchangeAsset::Patch& box);

/// For each patch the translations into the photograph that fit it best along its border, before any cut.
/// They lie apart from one another and from where the tile itself was cut, and the patch's box with half the
/// blending width around it lies inside the photograph. The best fit comes first; fewer than wanted where the
/// photograph holds no more. What it returns when `progress` stops it is of no use.
std::vector<std::vector<Candidate>> find_candidates(const PerceptualImage& photo,
                                                    const PerceptualImage& tile_colors,
                                                    const PeriodicTile& tile,
                                                    const Segmentation& segmentation,
                                                    const CandidateSearch& search, Progress& progress);

}  // namespace tessera
