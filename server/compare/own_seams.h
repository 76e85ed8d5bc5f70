#pragma once

#include <vector>

#include "server/prepare/tile.h"
#include "server/quality/measures.h"
#include "server/texture/rgb8_image.h"

namespace tessera {

/// Seams inside an image that was put together from a photograph: steps between texels that are neighbours
/// here and were none there.
struct OwnSeams {
    std::uint64_t pairs = 0;
    Steps ratio;  ///< Against the steps between neighbours that were neighbours.
};

/// `sources`: where each of the image's texels is from. `wraps`: the last row and column meet the first.
OwnSeams measure_own_seams(const Rgb8Image& image, const std::vector<PhotoPoint>& sources, bool wraps);

}  // namespace tessera
