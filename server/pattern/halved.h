#pragma once

#include <cstddef>
#include <cstdint>

#include "shared/page/texel_image.h"

namespace tessera {

/// The level above: means of 2 × 2 texels. Sides are even.
inline LinearImage halved(const LinearImage& fine) {
    LinearImage out{fine.width / 2, fine.height / 2};
    for (std::int32_t y = 0; y < out.height; ++y) {
        const float* upper = fine.row(2 * y);
        const float* lower = fine.row(2 * y + 1);
        float* texel = out.row(y);
        for (std::int32_t x = 0; x < out.width; ++x, upper += 8, lower += 8, texel += 4)
            for (std::size_t c = 0; c < 4; ++c)
                texel[c] = ((upper[c] + upper[c + 4]) + (lower[c] + lower[c + 4])) * 0.25F;
    }
    return out;
}

}  // namespace tessera
