#pragma once

#include <cstdint>
#include <vector>

namespace tessera {

/// An 8-bit RGB image, sRGB-coded unless its owner says that it is data; rows from the top.
struct Rgb8Image {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<std::uint8_t> bytes;  ///< 3·width·height
};

}  // namespace tessera
