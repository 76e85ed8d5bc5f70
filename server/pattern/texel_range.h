#pragma once

#include <array>
#include <vector>

#include "server/blocks/plan.h"

namespace tessera {

/// What is known of all of a texture's texels of level 0, wherever they are: the ranges that bounds on
/// composites are made of. Linear.
struct TexelRange {
    std::array<float, 4> least{0, 0, 0, 0};  ///< Premultiplied, alpha last.
    std::array<float, 4> most{1, 1, 1, 1};
    std::array<float, 4> straight_least{0, 0, 0, 1};  ///< Not premultiplied, where alpha is not 0.
    std::array<float, 4> straight_most{1, 1, 1, 1};

    bool opaque() const noexcept { return least[3] >= 1; }
    bool transparent() const noexcept { return most[3] <= 0; }
    bool constant() const noexcept { return least == most; }
};

/// Of `upper` composited over `lower`.
TexelRange range_over(const TexelRange& upper, const TexelRange& lower) noexcept;

/// Of a texture that shows either here and the other there.
TexelRange range_of_either(const TexelRange& a, const TexelRange& b) noexcept;

TexelRange texel_range(const ReferencePlan& plan);

/// Of each of the plan's textures, in their order.
std::vector<TexelRange> texel_ranges(const Plan& plan);

}  // namespace tessera
