#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/exchange_asset.h"

namespace tessera {

/// A grid of texels to divide into two: each texel's price for either side, and the price of a border between
/// neighbours. Prices are at most 2^24, so that no sum overflows.
struct CutGrid {
    std::int32_t width = 0, height = 0;
    std::vector<std::uint32_t>
        right;  ///< Border between (x, y) and (x + 1, y); width·height, the last column unused.
    std::vector<std::uint32_t> below;  ///< Between (x, y) and (x, y + 1); the last row unused.
    std::vector<std::uint32_t>
        outside;  ///< What it costs if the texel is outside the shape; forced in: `must`.
    std::vector<std::uint32_t> inside;  ///< What it costs if it is inside; forced out: `must`.
    static constexpr std::uint32_t must = std::uint32_t{1} << 30;

    CutGrid(std::int32_t w, std::int32_t h);
    std::size_t index(std::int32_t x, std::int32_t y) const noexcept {
        return std::size_t(y) * std::size_t(width) + std::size_t(x);
    }
};

/// The cheapest shape, by maximum flow (Boykov, Kolmogorov, "An experimental comparison of min-cut/max-flow
/// algorithms", PAMI 26(9), 2004). Among equally cheap ones the smallest, so that it does not depend on how
/// the flow was found.
struct ShapeCut {
    BitMask shape;
    std::uint64_t cost = 0;
};
ShapeCut cheapest_shape(const CutGrid& grid);

}  // namespace tessera
