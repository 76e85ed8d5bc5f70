#pragma once

#include <array>
#include <cstdint>

#include "shared/math/footprint.h"
#include "shared/page/page_key.h"

namespace tessera {

/// A texel of level 0, and where in it, 0 to 1.
struct LatticePoint {
    std::int64_t x = 0, y = 0;
    double in_x = 0, in_y = 0;
};

/// 2^−n, 0 <= n < 64.
inline double halved(int n) noexcept { return 1.0 / static_cast<double>(std::uint64_t{1} << n); }

/// The greatest integer that is not above |v| < 2^62.
inline std::int64_t floor_of(double v) noexcept {
    const auto whole = static_cast<std::int64_t>(v);
    return whole - (static_cast<double>(whole) > v ? 1 : 0);
}

inline LatticePoint lattice_point(const Footprint& footprint, TexelPoint from_origin) noexcept {
    const std::int64_t x = floor_of(from_origin.x), y = floor_of(from_origin.y);
    return {footprint.x + x, footprint.y + y, from_origin.x - static_cast<double>(x),
            from_origin.y - static_cast<double>(y)};
}

/// `count` with at least one bit: how many levels up `size` texels are at most `most`.
inline int level_of_at_most(double size, double most) noexcept {
    int level = 0;
    while (size > most && level < max_level) {
        size *= 0.5;
        ++level;
    }
    return level;
}

/// The box around a footprint, from its origin.
struct FootprintBox {
    double left = 0, top = 0, right = 0, bottom = 0;
    double width() const noexcept { return right - left; }
    double height() const noexcept { return bottom - top; }
};

inline FootprintBox box_of(const Footprint& footprint) noexcept {
    const auto& c = footprint.corners;
    FootprintBox box{c[0].x, c[0].y, c[0].x, c[0].y};
    for (const TexelPoint& p : {c[1], c[2], c[3]}) {
        box.left = p.x < box.left ? p.x : box.left;
        box.right = p.x > box.right ? p.x : box.right;
        box.top = p.y < box.top ? p.y : box.top;
        box.bottom = p.y > box.bottom ? p.y : box.bottom;
    }
    return box;
}

/// Counts texels of a level from the corner of the square of 2^shift texels of level 0 (shift >= level) in
/// which a footprint's box begins: small numbers, wherever the footprint lies.
struct LocalFrame {
    std::int64_t x = 0, y = 0;  ///< Which square.
    double left = 0, top = 0;   ///< From its corner to the footprint's origin, in texels of level 0.
    double scale = 1;           ///< Texels of the level in one of level 0.

    LocalFrame(const Footprint& footprint, const FootprintBox& box, int level, int shift) noexcept
        : x{(footprint.x + floor_of(box.left)) >> shift},
          y{(footprint.y + floor_of(box.top)) >> shift},
          left{static_cast<double>(footprint.x - x * (std::int64_t{1} << shift))},
          top{static_cast<double>(footprint.y - y * (std::int64_t{1} << shift))},
          scale{halved(level)} {}

    double across(double from_origin) const noexcept { return (from_origin + left) * scale; }
    double down(double from_origin) const noexcept { return (from_origin + top) * scale; }
    TexelPoint operator()(TexelPoint from_origin) const noexcept {
        return {across(from_origin.x), down(from_origin.y)};
    }
};

}  // namespace tessera
