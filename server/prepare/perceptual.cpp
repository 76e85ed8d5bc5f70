#include "server/prepare/perceptual.h"

#include <array>
#include <cmath>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

constexpr std::int64_t one = 8192;  ///< 1.0 of CIELAB's function f

/// The integer cube root, rounded down.
constexpr std::int64_t cube_root(std::int64_t value) {
    std::int64_t root = 0;
    for (std::int64_t bit = 1 << 14; bit > 0; bit /= 2)
        if ((root + bit) * (root + bit) * (root + bit) <= value) root += bit;
    return root;
}

/// f of each linear step (CIE 15: the cube root, and a straight line below (6/29)³), `one` being 1.0.
std::vector<std::int32_t> make_curve() {
    std::vector<std::int32_t> curve(65536);
    for (std::int64_t step = 0; step < 65536; ++step)
        curve[static_cast<std::size_t>(step)] = static_cast<std::int32_t>(
            step > 580 ? cube_root(step * one * one * one / 65535) : (step * 63791 + 32767) / 65535 + 1130);
    return curve;
}

}  // namespace

std::uint32_t color_distance(PerceptualColor a, PerceptualColor b) noexcept {
    const std::uint32_t square = static_cast<std::uint32_t>(difference(a, b)) << 4;
    // Whatever the guess, the integers decide
    auto root = static_cast<std::uint32_t>(std::sqrt(static_cast<float>(square)));
    while (root * root > square) --root;
    while ((root + 1) * (root + 1) <= square) ++root;
    return root;
}

PerceptualImage to_perceptual(const Rgb8Image& image) {
    static const std::vector<std::int32_t> curve = make_curve();
    PerceptualImage out{image.width, image.height, {}};
    out.colors.reserve(image.bytes.size() / 3);
    for (std::size_t i = 0; i + 2 < image.bytes.size(); i += 3) {
        const std::uint32_t red = srgb_to_steps[image.bytes[i]];
        const std::uint32_t green = srgb_to_steps[image.bytes[i + 1]];
        const std::uint32_t blue = srgb_to_steps[image.bytes[i + 2]];
        // sRGB's primaries (IEC 61966-2-1) in XYZ over D65 white, in 65536ths: each row sums to one
        const std::int32_t x = curve[(28440 * red + 24656 * green + 12440 * blue) >> 16];
        const std::int32_t y = curve[(13938 * red + 46868 * green + 4730 * blue) >> 16];
        const std::int32_t z = curve[(1164 * red + 7174 * green + 57198 * blue) >> 16];
        out.colors.push_back({static_cast<std::int16_t>((928 * y - 128 * 8192) >> 13),
                              static_cast<std::int16_t>((4000 * (x - y)) >> 13),
                              static_cast<std::int16_t>((1600 * (y - z)) >> 13)});
    }
    return out;
}

PerceptualImage reduced(const PerceptualImage& image, std::int32_t factor) {
    if (factor == 1) return image;
    PerceptualImage out{image.width / factor, image.height / factor, {}};
    out.colors.reserve(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
    for (std::int32_t y = 0; y < out.height; ++y)
        for (std::int32_t x = 0; x < out.width; ++x) {
            std::array<std::int32_t, 3> sum{};
            for (std::int32_t v = 0; v < factor; ++v)
                for (std::int32_t u = 0; u < factor; ++u) {
                    const PerceptualColor& color = image.at(x * factor + u, y * factor + v);
                    sum[0] += color.lightness;
                    sum[1] += color.green_red;
                    sum[2] += color.blue_yellow;
                }
            const std::int32_t texels = factor * factor;
            out.colors.push_back({static_cast<std::int16_t>(sum[0] / texels),
                                  static_cast<std::int16_t>(sum[1] / texels),
                                  static_cast<std::int16_t>(sum[2] / texels)});
        }
    return out;
}

}  // namespace tessera
