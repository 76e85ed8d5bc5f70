#include "client/render/overlay.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tessera {

std::array<float, 3> hue_of_level(int level) {
    const auto channel = [&](float phase) {
        const float turns = phase + 0.381966F * static_cast<float>(level);
        const float coded = 0.5F + 0.5F * std::cos(2 * std::numbers::pi_v<float> * turns);
        return coded;  // the shader squares it: about the same code
    };
    return {channel(0), channel(0.33F), channel(0.67F)};
}

std::array<float, 3> hue_of_age(float part) {
    constexpr std::array<std::array<float, 3>, 4> stops{
        {{1.0F, 0.36F, 0.22F}, {1.0F, 0.84F, 0.25F}, {0.25F, 0.75F, 0.60F}, {0.20F, 0.33F, 0.75F}}};
    const float at = std::clamp(part, 0.0F, 1.0F) * 3;
    const auto first = std::min(static_cast<std::size_t>(at), std::size_t{2});
    const float t = at - static_cast<float>(first);
    std::array<float, 3> colour{};
    for (std::size_t i = 0; i < 3; ++i)
        colour[i] = stops[first][i] + t * (stops[first + 1][i] - stops[first][i]);
    return colour;
}

}  // namespace tessera
