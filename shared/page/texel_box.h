#pragma once

#include <algorithm>
#include <cstdint>

namespace tessera {

/// Texels [x0, x1) × [y0, y1) of level 0 on the infinite lattice. Empty where x1 <= x0 or y1 <= y0.
struct TexelBox {
    std::int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    bool operator==(const TexelBox&) const = default;

    constexpr bool empty() const noexcept { return x1 <= x0 || y1 <= y0; }
    /// Whether they share a texel.
    constexpr bool meets(const TexelBox& other) const noexcept {
        return std::max(x0, other.x0) < std::min(x1, other.x1) &&
               std::max(y0, other.y0) < std::min(y1, other.y1);
    }
    constexpr TexelBox grown(std::int64_t by) const noexcept { return {x0 - by, y0 - by, x1 + by, y1 + by}; }
};

/// The smallest box around both; an empty one adds nothing.
constexpr TexelBox hull(const TexelBox& a, const TexelBox& b) noexcept {
    if (a.empty()) return b;
    if (b.empty()) return a;
    return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

}  // namespace tessera
