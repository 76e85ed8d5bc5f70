#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/blocks/pattern_images.h"
#include "shared/math/srgb.h"

namespace tessera {

/// All images of the set, premultiplied, in linear steps.
inline std::vector<std::uint16_t> premultiplied_steps(const PatternImages& patterns) {
    std::vector<std::uint16_t> steps(patterns.codes.size());
    for (std::size_t i = 0; i < steps.size(); i += 4) {
        const std::uint32_t alpha = patterns.codes[i + 3];
        for (std::size_t c = 0; c < 3; ++c)
            steps[i + c] =
                static_cast<std::uint16_t>((srgb_to_steps[patterns.codes[i + c]] * alpha + 127) / 255);
        steps[i + 3] = static_cast<std::uint16_t>(alpha * 257);
    }
    return steps;
}

}  // namespace tessera
