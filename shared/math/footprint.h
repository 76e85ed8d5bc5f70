#pragma once

#include <array>
#include <cstdint>

#include "shared/result/result.h"

namespace tessera {

/// A point of the plane of texels, or a difference of two; texel (i, j) covers [i, i + 1) × [j, j + 1).
struct TexelPoint {
    double x = 0, y = 0;
    bool operator==(const TexelPoint&) const = default;
};

/// What one sample must average: a convex quadrilateral of the infinite lattice of level 0. An integer origin
/// and small offsets, so that a footprint near texel 2^38 is as fine as one near 0.
struct Footprint {
    std::int64_t x = 0, y = 0;  ///< The origin: a texel of level 0, |x|, |y| <= max_footprint_origin.
    std::array<TexelPoint, 4> corners{};  ///< From the origin, in order around, either way; |x|, |y| <= 2^40.
    std::int64_t slice = 0;               ///< See TexelRegion::slice.
};

inline constexpr std::int64_t max_footprint_origin = std::int64_t{1} << 40;

/// Texels² inside the corners, at least 0.
double area_of(const Footprint& footprint) noexcept;

/// The parallelogram that best stands for a footprint, as filters with two axes see it: its middle, and half
/// the sums of opposite sides. `major` is the longer axis.
struct FootprintAxes {
    TexelPoint centre;  ///< From the origin.
    TexelPoint major, minor;
};
FootprintAxes axes_of(const Footprint& footprint) noexcept;

/// The parallelogram with this middle and these two sides (the axes are whole sides, not half ones).
Footprint footprint_around(std::int64_t x, std::int64_t y, TexelPoint centre, TexelPoint along,
                           TexelPoint across) noexcept;

/// invalid_input, naming the corner: not finite, out of range, or not convex (four corners on a line or in a
/// point are convex: a footprint may have no area).
Result<void> check_footprint(const Footprint& footprint);

}  // namespace tessera
