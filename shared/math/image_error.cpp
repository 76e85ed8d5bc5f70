#include "shared/math/image_error.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tessera {
namespace {

/// One channel in double precision, with a flag for each pixel.
struct Plane {
    std::int32_t width = 0, height = 0;
    std::vector<double> values;

    Plane(std::int32_t w, std::int32_t h) : width{w}, height{h}, values(std::size_t(w) * std::size_t(h)) {}
    double& at(std::int32_t x, std::int32_t y) noexcept { return values[index(x, y)]; }
    double at(std::int32_t x, std::int32_t y) const noexcept { return values[index(x, y)]; }

  private:
    std::size_t index(std::int32_t x, std::int32_t y) const noexcept {
        return std::size_t(y) * std::size_t(width) + std::size_t(x);
    }
};

constexpr std::int32_t window_side = 11, window_reach = window_side / 2;
constexpr std::array scale_exponents{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};
constexpr double exponent_sum = 1.0001;

/// exp(−d²/(2·1.5²)) for d of −5 to 5, scaled to the sum 1.
std::array<double, window_side> window_weights() {
    std::array<double, window_side> weights{};
    double sum = 0;
    for (std::int32_t i = 0; i < window_side; ++i) {
        const double d = i - window_reach;
        sum += weights[std::size_t(i)] = std::exp(-d * d / (2 * 1.5 * 1.5));
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

/// Weighted means over all windows that lie inside: 10 smaller each way.
Plane windowed(const Plane& in) {
    static const std::array<double, window_side> weights = window_weights();
    Plane rows(in.width - window_side + 1, in.height);
    for (std::int32_t y = 0; y < rows.height; ++y)
        for (std::int32_t x = 0; x < rows.width; ++x) {
            double sum = 0;
            for (std::int32_t i = 0; i < window_side; ++i) sum += weights[std::size_t(i)] * in.at(x + i, y);
            rows.at(x, y) = sum;
        }
    Plane out(rows.width, in.height - window_side + 1);
    for (std::int32_t y = 0; y < out.height; ++y)
        for (std::int32_t x = 0; x < out.width; ++x) {
            double sum = 0;
            for (std::int32_t i = 0; i < window_side; ++i) sum += weights[std::size_t(i)] * rows.at(x, y + i);
            out.at(x, y) = sum;
        }
    return out;
}

Plane product(const Plane& a, const Plane& b) {
    Plane out(a.width, a.height);
    std::ranges::transform(a.values, b.values, out.values.begin(), std::multiplies{});
    return out;
}

/// Means of 2×2 pixels.
Plane halved(const Plane& in) {
    Plane out(in.width / 2, in.height / 2);
    for (std::int32_t y = 0; y < out.height; ++y)
        for (std::int32_t x = 0; x < out.width; ++x)
            out.at(x, y) = (in.at(2 * x, 2 * y) + in.at(2 * x + 1, 2 * y) + in.at(2 * x, 2 * y + 1) +
                            in.at(2 * x + 1, 2 * y + 1)) /
                           4;
    return out;
}

/// Mean luminance term and mean product of contrast and structure at one scale.
struct Similarity {
    double luminance = 1, structure = 1;
};

Similarity similarity(const Plane& a, const Plane& b, const Plane& counted) {
    constexpr double c1 = (0.01 * 255) * (0.01 * 255), c2 = (0.03 * 255) * (0.03 * 255);
    const Plane mean_a = windowed(a), mean_b = windowed(b);
    const Plane square_a = windowed(product(a, a)), square_b = windowed(product(b, b)),
                both = windowed(product(a, b));
    double luminance = 0, structure = 0, count = 0;
    for (std::int32_t y = 0; y < mean_a.height; ++y)
        for (std::int32_t x = 0; x < mean_a.width; ++x) {
            const double weight = counted.at(x + window_reach, y + window_reach);
            if (!(weight > 0)) continue;
            const double ma = mean_a.at(x, y), mb = mean_b.at(x, y);
            const double variance_a = square_a.at(x, y) - ma * ma, variance_b = square_b.at(x, y) - mb * mb,
                         covariance = both.at(x, y) - ma * mb;
            luminance += weight * (2 * ma * mb + c1) / (ma * ma + mb * mb + c1);
            structure += weight * (2 * covariance + c2) / (variance_a + variance_b + c2);
            count += weight;
        }
    if (!(count > 0)) return {};
    return {luminance / count, structure / count};
}

Plane luma(const CodeImage& image) {
    Plane out(image.width, image.height);
    for (std::size_t i = 0; i < out.values.size(); ++i)
        out.values[i] = 0.299 * double(image.codes[3 * i]) + 0.587 * double(image.codes[3 * i + 1]) +
                        0.114 * double(image.codes[3 * i + 2]);
    return out;
}

bool counts(std::span<const std::uint8_t> measured, std::size_t pixel) {
    return measured.empty() || measured[pixel] != 0;
}

}  // namespace

double fractional_srgb_code(double linear) noexcept {
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

double srgb_codes_per_linear(double linear) noexcept {
    if (!(linear > 0.0031308)) return 255 * 12.92;
    return 255 * 1.055 / 2.4 * std::pow(std::min(linear, 1.0), 1 / 2.4 - 1);
}

double ms_ssim(const CodeImage& truth, const CodeImage& picture, std::span<const std::uint8_t> measured) {
    Plane a = luma(truth), b = luma(picture), counted(truth.width, truth.height);
    bool equal = true;
    for (std::size_t i = 0; i < counted.values.size(); ++i) {
        counted.values[i] = counts(measured, i) ? 1 : 0;
        if (counts(measured, i))
            equal = equal && a.values[i] == b.values[i];
        else
            b.values[i] = a.values[i];
    }
    if (equal) return 1;
    double value = 1, exponents = 0;
    std::size_t scale = 0;
    for (; scale < scale_exponents.size() && std::min(a.width, a.height) >= window_side; ++scale) {
        const Similarity found = similarity(a, b, counted);
        const bool coarsest =
            scale + 1 == scale_exponents.size() || std::min(a.width / 2, a.height / 2) < window_side;
        const double term = coarsest ? found.luminance * found.structure : found.structure;
        value *= std::pow(std::max(term, 0.0), scale_exponents[scale]);
        exponents += scale_exponents[scale];
        a = halved(a);
        b = halved(b);
        counted = halved(counted);
    }
    if (scale == 0) return 0;
    return scale == scale_exponents.size() ? value : std::pow(value, exponent_sum / exponents);
}

ImageError image_error(const CodeImage& truth, const CodeImage& picture,
                       std::span<const std::uint8_t> measured) {
    ImageError error;
    double squares = 0;
    std::size_t count = 0;
    const std::size_t pixels = truth.codes.size() / 3;
    for (std::size_t i = 0; i < pixels; ++i) {
        if (!counts(measured, i)) continue;
        ++count;
        for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const double d = double(picture.codes[c]) - double(truth.codes[c]);
            squares += d * d;
            error.max_error = std::max(error.max_error, std::fabs(d));
        }
    }
    error.psnr = most_psnr;
    if (count == 0) return error;
    error.mse = squares / double(3 * count);
    if (error.mse > 0) error.psnr = std::min(most_psnr, 10 * std::log10(255.0 * 255.0 / error.mse));
    error.ms_ssim = ms_ssim(truth, picture, measured);
    return error;
}

}  // namespace tessera
