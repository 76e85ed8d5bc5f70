#pragma once

#include <cstdint>

#include "server/prepare/perceptual.h"

namespace tessera {

/// What a border between the neighbouring texels s and t costs, where one side of it shows the layer a and the other
/// the layer b: the gradient that results (the mean of both ways round), and how much the layers differ at either
/// texel. Squared, so that one bad place costs more than many small ones. Below 2^24: a CutGrid takes it.
constexpr std::uint32_t seam_price(PerceptualColor a_s, PerceptualColor a_t, PerceptualColor b_s,
                                   PerceptualColor b_t) noexcept {
    return static_cast<std::uint32_t>((difference(a_s, b_t) + difference(b_s, a_t)) / 2 + difference(a_s, b_s) +
                                      difference(a_t, b_t)) +
           1;
}

}  // namespace tessera
