#include "server/scenes/patterns/lights.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/scenes/noise.h"
#include "server/scenes/pebble.h"
#include "shared/math/srgb.h"

namespace tessera::painting {
namespace {

constexpr std::int32_t grain = 6;  ///< Samples along the side of a texel.

/// A square picture of what paint(distance from the middle, height above it) says, in units of its side: a
/// premultiplied colour and alpha.
template <class Paint>
Rgba8Image paint_round(std::int32_t side, const Paint& paint) {
    Rgba8Image picture{side, side};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            std::array<double, 4> sum{};
            for (int sample = 0; sample < grain * grain; ++sample) {
                const double dx = (x + (sample % grain + 0.5) / grain) / side - 0.5;
                const double dy = (y + (sample / grain + 0.5) / grain) / side - 0.5;
                const std::array<double, 4> here = paint(std::sqrt(dx * dx + dy * dy), dy);
                for (std::size_t c = 0; c < 4; ++c) sum[c] += here[c] / (grain * grain);
            }
            std::uint8_t* code = &picture.bytes[static_cast<std::size_t>(y * side + x) * 4];
            for (std::size_t c = 0; c < 3; ++c)
                code[c] = steps_to_srgb()[to_steps(static_cast<float>(sum[3] > 0 ? sum[c] / sum[3] : 0.0))];
            code[3] = static_cast<std::uint8_t>(std::clamp(sum[3], 0.0, 1.0) * 255 + 0.5);
        }
    return picture;
}

LinearColor mixed(const LinearColor& a, const LinearColor& b, double t) {
    LinearColor color;
    for (std::size_t c = 0; c < 3; ++c) color[c] = a[c] + (b[c] - a[c]) * t;
    return color;
}

}  // namespace

Rgba8Image paint_led(double lit, std::int32_t side) {
    constexpr double radius = 0.34;
    return paint_round(side, [&](double r, double dy) -> std::array<double, 4> {
        // The board, with the diode's shine on it
        const double halo = lit * smooth_step(0.5, radius, r);
        LinearColor color{0.006 + 0.16 * halo * halo, 0.006, 0.007};
        // The diode: dark glass that shines from its middle
        const double inside = smooth_step(radius + 0.02, radius - 0.02, r);
        const double core = smooth_step(radius, 0.0, r);
        const LinearColor out = mixed({0.035, 0.004, 0.004}, {0.10, 0.02, 0.02}, core * (0.5 - dy));
        const LinearColor on = mixed({0.72, 0.018, 0.008}, {1.0, 0.36, 0.20}, core * core);
        color = mixed(color, mixed(out, on, lit), inside);
        return {color[0], color[1], color[2], 1};
    });
}

Rgba8Image paint_glow(double lit, std::int32_t side) {
    return paint_round(side, [&](double r, double) -> std::array<double, 4> {
        const double reach = smooth_step(0.5, 0.0, r);
        const double core = smooth_step(0.09, 0.05, r);
        const double alpha = lit * std::max(reach * reach * reach * 0.75, core);
        const LinearColor color = mixed({0.55, 0.62, 0.10}, {1.0, 0.98, 0.72}, core);
        return {alpha * color[0], alpha * color[1], alpha * color[2], alpha};
    });
}

}  // namespace tessera::painting
