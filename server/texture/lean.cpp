#include "server/texture/lean.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr double slope_one = 32767.0;  ///< Steps of the range.
constexpr double half_one = 65536.0;   ///< What the high half counts.
constexpr double fourth_of_255 = 255.0 * 255.0 * 255.0 * 255.0;

/// Half a step of what is rounded, and a twentieth for floats.
constexpr double lost_steps = 0.55;
/// Of a filtered value that is the same everywhere: two roundings to 24 bits of a number below 1.
constexpr double float_error = 1.2e-7;

/// Of ±range, nearest.
int slope_steps(double slope, double range) noexcept {
    return static_cast<int>(std::lround(slope / range * slope_one));
}

struct SlopeSteps {
    std::int64_t x = 0, y = 0;
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

void put_halves(std::uint32_t value, std::uint16_t* out) noexcept {
    out[0] = static_cast<std::uint16_t>(value >> 16);
    out[1] = static_cast<std::uint16_t>(value & 65535u);
}
double whole(const float* halves) noexcept {
    return (double{halves[0]} * half_one + double{halves[1]}) * 65535.0;
}

/// Signed values around the middle: −1 to 1.
std::uint16_t centred_steps(double value) noexcept {
    return static_cast<std::uint16_t>(std::lround(value * slope_one) + 32768);
}
double centred(float value) noexcept { return (double{value} * 65535.0 - 32768.0) / slope_one; }

/// `value` nearer to 0 by `by`, and no further from it than `most`.
double shrunk(double value, double by, double most) noexcept {
    return std::copysign(std::clamp(std::abs(value) - by, 0.0, most), value);
}

std::uint32_t squared_alpha_of(const Rgb8Image* roughness, std::size_t texel) noexcept {
    const std::uint32_t code = roughness == nullptr ? 0 : roughness->bytes[3 * texel];
    return code * code * code * code;  // at most 255⁴ < 2³²
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

Rgb16Image lean_squares(const Rgb8Image& normals, double range) {
    return made(normals, [&](std::size_t texel, std::uint16_t* out) {
        const auto [x, y] = steps_at(normals, texel, range);
        put_halves(static_cast<std::uint32_t>(x * x + y * y), out);
        out[2] = centred_steps(static_cast<double>(x * x - y * y) / (slope_one * slope_one));
    });
}

Rgb16Image lean_products(const Rgb8Image& normals, double range, const Rgb8Image* roughness) {
    return made(normals, [&](std::size_t texel, std::uint16_t* out) {
        const auto [x, y] = steps_at(normals, texel, range);
        put_halves(squared_alpha_of(roughness, texel), out);
        out[2] = centred_steps(static_cast<double>(x * y) / (slope_one * slope_one));
    });
}

Rgb16Image squared_alphas(const Rgb8Image& roughness, const Rgb8Image* third) {
    return made(roughness, [&](std::size_t texel, std::uint16_t* out) {
        put_halves(squared_alpha_of(&roughness, texel), out);
        out[2] = third_at(third, texel);
    });
}

Slopes lean_mean(const float* slopes, double range) noexcept {
    return {centred(slopes[0]) * range, centred(slopes[1]) * range};
}

LeanTexel lean_texel(const float* slopes, const float* squares, const float* products,
                     double range) noexcept {
    const double x = centred(slopes[0]), y = centred(slopes[1]), unit = range * range;
    const double squared = whole(squares) / (slope_one * slope_one);
    // Slopes are twice as wide as the values that carry them, and a square moves by twice its root
    const double lost =
        float_error * (4 * (std::abs(x) + std::abs(y)) + squared) + 8 * float_error * float_error;
    const double trace = std::max(0.0, squared - x * x - y * y - lost);
    const double difference = shrunk(centred(squares[2]) - (x * x - y * y), lost_steps / slope_one, trace);
    const double product = shrunk(centred(products[2]) - x * y, lost_steps / slope_one, trace / 2);
    return {{x * range, y * range},
            trace * unit,
            (trace + difference) / 2 * unit,
            (trace - difference) / 2 * unit,
            product * unit};
}

LeanError lean_error(double error, double range) noexcept {
    const double unit = range * range;
    const double of_means = 8.001 * error;  // of x² + y², |x| and |y| ≤ 1
    const double trace = of_means + 4.001 * error + 12 * float_error;
    const double difference = of_means + 2.001 * error + 2 * lost_steps / slope_one;
    return {trace * unit, (trace + difference) / 2 * unit,
            (of_means / 2 + 2.001 * error + 2 * lost_steps / slope_one) * unit};
}

double squared_alpha(const float* halves) noexcept {
    return std::clamp(whole(halves) / fourth_of_255, 0.0, 1.0);
}

double squared_alpha_error(double halves_error) noexcept {
    return halves_error * (half_one + 1) * 65535.0 / fourth_of_255;
}

double rougher(double squared, const LeanTexel& texel) noexcept {
    return roughness_of(std::min(1.0, squared + texel.trace));
}

double roughness_of(double squared) noexcept { return std::sqrt(std::sqrt(squared)); }

}  // namespace tessera
