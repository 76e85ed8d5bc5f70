#pragma once

#include <vector>

#include "client/residency/plane_view.h"
#include "client/residency/sampling.h"
#include "shared/page/page_key.h"

namespace tessera {

struct NeededPage {
    PageKey key;
    double pixels = 0;  ///< Of the picture that sample this page, in part or wholly; at most a bit too many.
};

/// Every page that filtering `view` with this sampling reads, clamped to the extent's levels; `lod_bias` is
/// added to each pixel's level. Known in the same frame, without asking the GPU. Coarse levels first. The
/// clip centre lies inside the extent.
std::vector<NeededPage> needed_pages(const PlaneView& view, Extent extent, double lod_bias,
                                     const Sampling& sampling = {});

}  // namespace tessera
