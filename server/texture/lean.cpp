#include "server/texture/lean.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr double square_steps = 65535.0, product_steps = 32767.0;
/// Half a step of M's rounding, and a twentieth for floats of 24 bits that carry means and squares.
constexpr double lost_steps = 0.55;

/// Of ±range, nearest.
int slope_steps(double slope, double range) noexcept {
    return static_cast<int>(std::lround(slope / range * product_steps));
}

struct SlopeSteps {
    int x = 0, y = 0;
};
SlopeSteps steps_at(const Rgb8Image& normals, std::size_t texel, double range) noexcept {
    const std::uint8_t* code = normals.bytes.data() + 3 * texel;
    const Slopes slopes = slopes_of(code[0], code[1], code[2]);
    return {slope_steps(slopes.x, range), slope_steps(slopes.y, range)};
}

std::size_t texels_of(const Rgb8Image& image) noexcept {
    return std::size_t(image.width) * std::size_t(image.height);
}

std::uint16_t third_at(const Rgb8Image* third, std::size_t texel) noexcept {
    return third == nullptr ? std::uint16_t{0} : static_cast<std::uint16_t>(third->bytes[3 * texel] * 257);
}

template <class Fill>
Rgb16Image made(const Rgb8Image& from, const Fill& fill) {
    Rgb16Image image{from.width, from.height, std::vector<std::uint16_t>(3 * texels_of(from))};
    for (std::size_t texel = 0; texel < texels_of(from); ++texel) fill(texel, &image.values[3 * texel]);
    return image;
}

}  // namespace

Slopes slopes_of(std::uint8_t red, std::uint8_t green, std::uint8_t blue) noexcept {
    const double x = 2.0 * red - 255.0, y = 2.0 * green - 255.0, z = 2.0 * blue - 255.0;
    const double across = std::max(std::abs(x), std::abs(y));
    if (z * steepest_slope > across) return {x / z, y / z};
    return {x / across * steepest_slope, y / across * steepest_slope};
}

double steepest_in(const Rgb8Image& normals) noexcept {
    double steepest = 0;
    for (std::size_t i = 0; i + 2 < normals.bytes.size(); i += 3) {
        const Slopes slopes = slopes_of(normals.bytes[i], normals.bytes[i + 1], normals.bytes[i + 2]);
        steepest = std::max({steepest, std::abs(slopes.x), std::abs(slopes.y)});
    }
    return steepest;
}

Rgb16Image lean_slopes(const Rgb8Image& normals, double range, const Rgb8Image* third) {
    return made(normals, [&](std::size_t texel, std::uint16_t* out) {
        const SlopeSteps steps = steps_at(normals, texel, range);
        out[0] = static_cast<std::uint16_t>(steps.x + 32768);
        out[1] = static_cast<std::uint16_t>(steps.y + 32768);
        out[2] = third_at(third, texel);
    });
}

Rgb16Image lean_moments(const Rgb8Image& normals, double range) {
    return made(normals, [&](std::size_t texel, std::uint16_t* out) {
        const SlopeSteps steps = steps_at(normals, texel, range);
        const double x = steps.x / product_steps, y = steps.y / product_steps;
        out[0] = static_cast<std::uint16_t>(std::lround(x * x * square_steps));
        out[1] = static_cast<std::uint16_t>(std::lround(y * y * square_steps));
        out[2] = static_cast<std::uint16_t>(std::lround(x * y * product_steps) + 32768);
    });
}

LeanTexel lean_texel(const float* slopes, const float* moments, double range) noexcept {
    const auto centred = [](float value) { return (double{value} * 65535.0 - 32768.0) / product_steps; };
    const double x = centred(slopes[0]), y = centred(slopes[1]), unit = range * range;
    const double variance_x = std::max(0.0, double{moments[0]} - x * x - lost_steps / square_steps);
    const double variance_y = std::max(0.0, double{moments[1]} - y * y - lost_steps / square_steps);
    const double product = centred(moments[2]) - x * y;
    const double size = std::max(0.0, std::abs(product) - lost_steps / product_steps);
    return {
        {x * range, y * range}, variance_x * unit, variance_y * unit, (product < 0 ? -size : size) * unit};
}

LeanError lean_error(double slopes_error, double moments_error, double range) noexcept {
    // Slopes are twice their value wide, and a square moves by twice its root: |B| ≤ 1 in units of the range
    const double unit = range * range, of_means = 4 * slopes_error;
    return {unit * (of_means + moments_error + 2 * lost_steps / square_steps),
            unit * (of_means + 2 * moments_error + 2 * lost_steps / product_steps)};
}

Rgb16Image squared_alphas(const Rgb8Image& roughness, const Rgb8Image* third) {
    return made(roughness, [&](std::size_t texel, std::uint16_t* out) {
        const std::uint32_t code = roughness.bytes[3 * texel];
        const std::uint32_t fourth = code * code * code * code;  // at most 255⁴ < 2³²
        out[0] = static_cast<std::uint16_t>(fourth >> 16);
        out[1] = static_cast<std::uint16_t>(fourth & 65535u);
        out[2] = third_at(third, texel);
    });
}

namespace {
constexpr double fourth_of_255 = 255.0 * 255.0 * 255.0 * 255.0;
}

double squared_alpha(const float* halves) noexcept {
    return std::clamp((double{halves[0]} * 65536.0 + double{halves[1]}) * 65535.0 / fourth_of_255, 0.0, 1.0);
}

double squared_alpha_error(double halves_error) noexcept {
    return halves_error * 65537.0 * 65535.0 / fourth_of_255;
}

double rougher(double squared, const LeanTexel& texel) noexcept {
    return roughness_of(std::min(1.0, squared + texel.variance_x + texel.variance_y));
}

double roughness_of(double squared) noexcept { return std::sqrt(std::sqrt(squared)); }

}  // namespace tessera
