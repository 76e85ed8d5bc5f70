#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "server/prepare/perceptual.h"

namespace tessera {

namespace seam_detail {

/// Sixteen times the square root of 16·i, rounded down.
inline constexpr auto roots = [] {
    std::array<std::uint16_t, 65536> table{};
    std::uint32_t root = 0;
    for (std::uint32_t i = 0; i < table.size(); ++i) {
        while ((root + 1) * (root + 1) <= i * 4096) ++root;
        table[i] = static_cast<std::uint16_t>(root);
    }
    return table;
}();

}  // namespace seam_detail

/// How far two colours lie apart, in 128ths of a CIELAB unit; what is beyond 128 units counts as that.
inline std::uint32_t distance(PerceptualColor a, PerceptualColor b) noexcept {
    return seam_detail::roots[static_cast<std::size_t>(std::min(difference(a, b) >> 4, 65535))];
}

/// The mean step from texel to texel of a photograph of at least 2×2, as distance() has it; at least 16.
inline std::uint32_t mean_gradient(const PerceptualImage& photo) {
    std::uint64_t sum = 0, pairs = 0;
    for (std::int32_t y = 0; y + 1 < photo.height; ++y)
        for (std::int32_t x = 0; x + 1 < photo.width; ++x, pairs += 2)
            sum +=
                distance(photo.at(x, y), photo.at(x + 1, y)) + distance(photo.at(x, y), photo.at(x, y + 1));
    return static_cast<std::uint32_t>(std::max<std::uint64_t>(sum / pairs, 16));
}

/// What a border between the neighbouring texels s and t costs, where one side of it shows the layer a and
/// the other the layer b: the gradient that results (both ways round), and how much the layers differ at
/// either texel. Below 2^16 + 2. Distances, not their squares: many small steps are seen as much as one large
/// one.
inline std::uint32_t seam_price(PerceptualColor a_s, PerceptualColor a_t, PerceptualColor b_s,
                                PerceptualColor b_t) noexcept {
    return distance(a_s, b_t) + distance(b_s, a_t) + distance(a_s, b_s) + distance(a_t, b_t) + 1;
}

}  // namespace tessera
