#include "server/scenes/patterns/canvas.h"

#include <cmath>

#include "server/scenes/pebble_light.h"
#include "shared/math/srgb.h"

namespace tessera::painting {
namespace {

constexpr LinearColor sun_color{1.28, 1.17, 0.98};
constexpr LinearColor sky_color{0.40, 0.46, 0.56};

std::uint8_t to_code(double linear) noexcept {
    // A soft shoulder keeps what is bright from burning out
    const double toned = linear < 0.6 ? linear : 0.6 + (linear - 0.6) / (1.0 + (linear - 0.6) / 0.4);
    return steps_to_srgb()[to_steps(static_cast<float>(toned))];
}

/// The mean of 2·radius + 1 values along lines of `stride`; what is outside is as at the border.
void blur_lines(const std::vector<float>& from, std::vector<float>& to, std::int32_t n, std::int32_t radius,
                std::size_t line, std::size_t stride) {
    const double share = 1.0 / (2 * radius + 1);
    for (std::int32_t l = 0; l < n; ++l) {
        const std::size_t start = static_cast<std::size_t>(l) * line;
        const auto value = [&](std::int32_t i) {
            return double{from[start + static_cast<std::size_t>(std::clamp(i, 0, n - 1)) * stride]};
        };
        double sum = 0;
        for (std::int32_t i = -radius; i <= radius; ++i) sum += value(i);
        for (std::int32_t i = 0; i < n; ++i) {
            to[start + static_cast<std::size_t>(i) * stride] = static_cast<float>(sum * share);
            sum += value(i + radius + 1) - value(i - radius);
        }
    }
}

}  // namespace

Canvas::Canvas(std::int32_t side, std::int32_t grain) : side_{side}, grain_{grain}, samples_{side * grain} {
    const std::size_t count = std::size_t(samples_) * std::size_t(samples_);
    height_.resize(count);
    alpha_.resize(count);
    slope_x_.resize(count);
    slope_y_.resize(count);
    color_.resize(count);
}

std::size_t Canvas::at(double x, double y) const noexcept {
    const auto inside = [this](double texel) {
        return static_cast<std::size_t>(
            std::clamp<std::int64_t>(whole_below(texel * grain_), 0, samples_ - 1));
    };
    return inside(y) * std::size_t(samples_) + inside(x);
}

void Canvas::take_slopes() {
    const std::int32_t n = samples_;
    const auto h = [&](std::int32_t x, std::int32_t y) {
        return double{height_[std::size_t(y) * std::size_t(n) + std::size_t(x)]};
    };
    for (std::int32_t y = 0; y < n; ++y)
        for (std::int32_t x = 0; x < n; ++x) {
            const std::int32_t i = std::min(x, n - 2), j = std::min(y, n - 2);
            const std::size_t k = std::size_t(y) * std::size_t(n) + std::size_t(x);
            slope_x_[k] = static_cast<float>(std::clamp((h(i + 1, y) - h(i, y)) * grain_, -cliff, cliff));
            slope_y_[k] = static_cast<float>(std::clamp((h(x, j + 1) - h(x, j)) * grain_, -cliff, cliff));
        }
}

std::vector<float> Canvas::blurred(std::int32_t radius) const {
    std::vector<float> across(height_.size()), both(height_.size());
    const auto n = static_cast<std::size_t>(samples_);
    blur_lines(height_, across, samples_, radius, n, 1);
    blur_lines(across, both, samples_, radius, 1, n);
    blur_lines(both, across, samples_, radius, n, 1);  // twice: a tent, which shows no squares
    blur_lines(across, both, samples_, radius, 1, n);
    return both;
}

double Canvas::sunlight(std::int32_t x, std::int32_t y) const noexcept {
    const double rise = sun_z / std::sqrt(sun_x * sun_x + sun_y * sun_y);
    const double here = double{height_[std::size_t(y) * std::size_t(samples_) + std::size_t(x)]};
    double hidden = 0;
    double far = 0.6;
    for (int i = 0; i < 10; ++i, far *= 1.32) {  // to 7 texels away
        const double above =
            height((x + 0.5) / grain_ + far * sun_x * 1.42, (y + 0.5) / grain_ + far * sun_y * 1.42);
        hidden = std::max(hidden, (above - here - far * rise) / (0.25 + 0.12 * far));
    }
    return 1.0 - smooth_step(0.0, 1.5, hidden);
}

Rgba8Image Canvas::develop(const Light& light) const {
    const std::vector<float> near = blurred(std::max(1, grain_)), wide = blurred(3 * grain_);
    Rgba8Image picture{side_, side_};
    for (std::int32_t y = 0; y < side_; ++y)
        for (std::int32_t x = 0; x < side_; ++x) {
            LinearColor sum{};
            double covered = 0;
            for (std::int32_t j = y * grain_; j < (y + 1) * grain_; ++j)
                for (std::int32_t i = x * grain_; i < (x + 1) * grain_; ++i) {
                    const std::size_t k = std::size_t(j) * std::size_t(samples_) + std::size_t(i);
                    if (alpha_[k] <= 0) continue;
                    const double sx = double{slope_x_[k]}, sy = double{slope_y_[k]};
                    const double length = std::sqrt(sx * sx + sy * sy + 1.0);
                    const double facing = std::max(0.0, (sun_z - sx * sun_x - sy * sun_y) / length);
                    const double lower = std::max(0.0, double{near[k]} - double{height_[k]}) * 0.55 +
                                         std::max(0.0, double{wide[k]} - double{height_[k]}) * 0.30;
                    const double open = 1.0 / (1.0 + light.shade * lower);
                    const double sun = light.shadows && facing > 0 ? sunlight(i, j) : 1.0;
                    const double sky = open * (0.5 + 0.5 / length);
                    const double a = double{alpha_[k]};
                    for (std::size_t c = 0; c < 3; ++c)
                        sum[c] += a * color_[k][c] * light.level *
                                  (light.sun * sun_color[c] * facing * sun * (0.35 + 0.65 * open) +
                                   light.sky * sky_color[c] * sky + light.glow * open);
                    covered += a;
                }
            std::uint8_t* texel = picture.row(y) + std::ptrdiff_t{4} * x;
            for (std::size_t c = 0; c < 3; ++c)
                texel[c] = covered > 0 ? to_code(sum[c] / covered) : std::uint8_t{0};
            texel[3] = static_cast<std::uint8_t>(covered / (grain_ * grain_) * 255.0 + 0.5);
            if (texel[3] == 0) std::fill_n(texel, 3, std::uint8_t{0});
        }
    return picture;
}

Rgba8Image sheet_of(const std::vector<Rgba8Image>& patterns, std::int32_t columns) {
    const std::int32_t side = patterns.front().width;
    const auto count = static_cast<std::int32_t>(patterns.size());
    Rgba8Image sheet{columns * side, (count + columns - 1) / columns * side};
    for (std::int32_t i = 0; i < count; ++i)
        for (std::int32_t y = 0; y < side; ++y)
            std::copy_n(patterns[static_cast<std::size_t>(i)].row(y), std::ptrdiff_t{4} * side,
                        sheet.row(i / columns * side + y) + std::ptrdiff_t{4} * side * (i % columns));
    return sheet;
}

}  // namespace tessera::painting
