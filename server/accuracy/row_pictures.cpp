#include "server/accuracy/row_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/quality/small_text.h"

namespace tessera {
namespace {

using Color = std::array<double, 3>;

constexpr Color green{18, 148, 84}, red{214, 48, 49}, even{246, 241, 226}, magnified{128, 128, 128},
    sky{34, 36, 42};
constexpr double decades = 3;  ///< Factors of 2^3 either way are the full colours.

std::uint8_t code(double value) { return static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0)); }

void put(Rgba8Image& image, std::int32_t x, std::int32_t y, const Color& color) {
    std::uint8_t* texel = image.row(y) + std::ptrdiff_t{4} * x;
    for (std::size_t c = 0; c < 3; ++c) texel[c] = code(color[c]);
    texel[3] = 255;
}

/// −1 to 1: from far fewer to far more.
Color balance(double at) {
    const Color& end = at < 0 ? green : red;
    const double strength = std::sqrt(std::min(std::fabs(at), 1.0));
    Color out;
    for (std::size_t c = 0; c < 3; ++c) out[c] = even[c] + (end[c] - even[c]) * strength;
    return out;
}

void draw_legend(Rgba8Image& image, std::int32_t top) {
    constexpr std::int32_t margin = 6, bar = 8;
    const std::int32_t width = image.width;
    for (std::int32_t y = top; y < image.height; ++y)
        for (std::int32_t x = 0; x < width; ++x) put(image, x, y, {255, 255, 255});
    for (std::int32_t x = margin; x < width - margin; ++x)
        for (std::int32_t y = top + 4; y < top + 4 + bar; ++y)
            put(image, x, y, balance(2.0 * (x - margin) / (width - 2 * margin - 1) - 1));
    constexpr std::array<std::uint8_t, 3> black{40, 40, 40};
    const std::int32_t row = top + 4 + bar + 3;
    const auto centred = [&](std::int32_t x, std::string_view text) {
        draw_text(image,
                  std::clamp(x - text_width(text, 1) / 2, margin, width - margin - text_width(text, 1)), row,
                  text, 1, black);
    };
    centred(margin, "16");
    centred(width / 2, "128 texels");
    centred(width - margin, "1024");
}

}  // namespace

Rgba8Image shown(const CodeImage& picture) {
    Rgba8Image out(picture.width, picture.height);
    for (std::int32_t y = 0; y < picture.height; ++y)
        for (std::int32_t x = 0; x < picture.width; ++x) {
            const float* p = picture.pixel(x, y);
            put(out, x, y, {double(p[0]), double(p[1]), double(p[2])});
        }
    return out;
}

Rgba8Image shown_error(const CodeImage& truth, const CodeImage& picture) {
    Rgba8Image out(picture.width, picture.height);
    for (std::int32_t y = 0; y < picture.height; ++y)
        for (std::int32_t x = 0; x < picture.width; ++x) {
            Color color;
            for (std::size_t c = 0; c < 3; ++c)
                color[c] =
                    error_gain * std::fabs(double(picture.pixel(x, y)[c]) - double(truth.pixel(x, y)[c]));
            put(out, x, y, color);
        }
    return out;
}

Rgba8Image shown_counts(const View& view, const FilterMeasurement& measurement) {
    constexpr std::int32_t legend_height = 26;
    const std::int32_t width = view.situation.width, height = view.situation.height;
    Rgba8Image out(width, height + legend_height);
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x) put(out, x, y, sky);
    for (std::size_t i = 0; i < view.pixels.size() && i < measurement.texels.size(); ++i) {
        const auto x = static_cast<std::int32_t>(view.pixels[i] % std::size_t(width)),
                   y = static_cast<std::int32_t>(view.pixels[i] / std::size_t(width));
        const double texels = std::max<double>(measurement.texels[i], 1);
        put(out, x, y,
            area_of(view.footprints[i]) < 1 ? magnified : balance(std::log2(texels / even_texels) / decades));
    }
    draw_legend(out, height);
    return out;
}

}  // namespace tessera
