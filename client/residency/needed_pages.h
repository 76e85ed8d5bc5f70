#pragma once

#include <vector>

#include "client/residency/plane_view.h"
#include "shared/page/page_key.h"

namespace tessera {

struct NeededPage {
    PageKey key;
    double pixels = 0;  ///< Of the picture that sample this page, in part or wholly; at most a bit too many.
};

/// Every page that trilinear filtering of `view` samples: the pages of the two levels around each pixel's
/// level (+ `lod_bias`), clamped to the extent's levels. Found by walking the quadtree from the coarsest page
/// and clipping each page's square to the view, so it is known in the same frame, without asking the GPU.
/// Coarse levels first. The clip centre lies inside the extent.
std::vector<NeededPage> needed_pages(const PlaneView& view, Extent extent, double lod_bias);

}  // namespace tessera
