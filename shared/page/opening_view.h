#pragma once

#include <cstdint>

namespace tessera {

/// Where a view of a scene begins whose address says nothing.
struct OpeningView {
    std::int64_t x = 0;  ///< The texel of level 0 in its middle, inside the extent.
    std::int64_t y = 0;
    double level = 1;  ///< log2 of the texels under a pixel, min_view_level to the extent's n.
    bool operator==(const OpeningView&) const = default;
};

inline constexpr double min_view_level = -6;  ///< A texel is 64 pixels.

}  // namespace tessera
