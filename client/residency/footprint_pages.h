#pragma once

#include <vector>

#include "client/residency/needed_pages.h"

namespace tessera {

/// needed_pages() for samplings whose level depends on a footprint's shape: the picture is looked at in
/// blocks of some pixels, by the footprints at their corners.
std::vector<NeededPage> needed_by_footprints(const PlaneView& view, Extent extent, double lod_bias,
                                             const Sampling& sampling);

}  // namespace tessera
