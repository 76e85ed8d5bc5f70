#pragma once

#include <cstdint>
#include <vector>

namespace tessera {

/// The patterns of a set, as they were read: sRGB codes, alpha straight.
struct PatternImages {
    std::int32_t side = 0;    ///< Of a pattern, in texels: a power of two, 1 to 1024.
    std::int32_t count = 0;   ///< Of patterns.
    std::int32_t slices = 1;  ///< Images of each pattern: 1 without a third dimension.
    std::vector<std::uint8_t>
        codes;  ///< RGBA: 4·side² bytes an image, image pattern·slices + slice, rows from the top.

    const std::uint8_t* image(std::int32_t pattern, std::int32_t slice) const noexcept {
        return codes.data() + (static_cast<std::size_t>(pattern) * static_cast<std::size_t>(slices) +
                               static_cast<std::size_t>(slice)) *
                                  static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 4;
    }
};

}  // namespace tessera
