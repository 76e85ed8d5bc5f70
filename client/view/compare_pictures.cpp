#include "client/view/compare_pictures.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr std::uint8_t unmeasured = 40;

std::uint8_t rounded(double code) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(code, 0.0, 255.0)));
}

/// Calls colour(index of the pixel) -> three codes for what was measured.
template <class Colour>
Rgba8Image painted(std::int32_t width, std::int32_t height, const std::vector<std::uint8_t>& measured,
                   Colour colour) {
    Rgba8Image image{width, height};
    for (std::size_t at = 0; at < measured.size(); ++at) {
        std::uint8_t* pixel = image.bytes.data() + 4 * at;
        std::fill_n(pixel, 3, unmeasured);
        pixel[3] = 255;
        if (!measured[at]) continue;
        const std::array<double, 3> codes = colour(at);
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = rounded(codes[c]);
    }
    return image;
}

}  // namespace

CodeImage codes_of(const FloatPicture& picture) {
    CodeImage codes{picture.width, picture.height};
    for (std::size_t at = 0; at < picture.values.size() / 4; ++at)
        for (std::size_t c = 0; c < 3; ++c)
            codes.codes[3 * at + c] =
                static_cast<float>(fractional_srgb_code(static_cast<double>(picture.values[4 * at + c])));
    return codes;
}

Rgba8Image shown(const CodeImage& codes, const std::vector<std::uint8_t>& measured) {
    return painted(codes.width, codes.height, measured, [&](std::size_t at) {
        return std::array<double, 3>{codes.codes[3 * at], codes.codes[3 * at + 1], codes.codes[3 * at + 2]};
    });
}

Rgba8Image difference(const CodeImage& truth, const CodeImage& codes,
                      const std::vector<std::uint8_t>& measured) {
    return painted(codes.width, codes.height, measured, [&](std::size_t at) {
        std::array<double, 3> errors;
        for (std::size_t c = 0; c < 3; ++c)
            errors[c] =
                8.0 * std::abs(static_cast<double>(codes.codes[3 * at + c] - truth.codes[3 * at + c]));
        return errors;
    });
}

Rgba8Image texel_map(const FloatPicture& picture, const FloatPicture& reference,
                     const std::vector<std::uint8_t>& measured) {
    const CodeImage codes = codes_of(picture);
    return painted(picture.width, picture.height, measured, [&](std::size_t at) {
        const double grey = 0.5 * (0.21 * codes.codes[3 * at] + 0.72 * codes.codes[3 * at + 1] +
                                   0.07 * codes.codes[3 * at + 2]) +
                            64;
        const double texels = std::max(1.0, static_cast<double>(picture.values[4 * at + 3])),
                     usual = std::max(1.0, static_cast<double>(reference.values[4 * at + 3]));
        const double more = std::clamp(std::log2(texels / usual) / 2, -1.0, 1.0);
        const double tint = std::abs(more);
        return std::array<double, 3>{grey * (1 - tint) + (more > 0 ? 230 : 30) * tint,
                                     grey * (1 - tint) + (more < 0 ? 200 : 40) * tint,
                                     grey * (1 - tint) + 50 * tint};
    });
}

Rgba8Image cut(const Rgba8Image& image, int left, int top, int width, int height) {
    Rgba8Image part{width, height};
    for (int y = 0; y < height; ++y) std::copy_n(image.row(top + y) + 4 * left, 4 * width, part.row(y));
    return part;
}

Rgba8Image sheet(const std::vector<std::vector<Rgba8Image>>& columns) {
    constexpr int gap = 4;
    const int width = columns.front().front().width, height = columns.front().front().height;
    const auto across = static_cast<int>(columns.size()), down = static_cast<int>(columns.front().size());
    Rgba8Image whole{across * (width + gap) - gap, down * (height + gap) - gap};
    std::ranges::fill(whole.bytes, std::uint8_t{255});
    for (int x = 0; x < across; ++x) {
        for (int y = 0; y < down; ++y) {
            const Rgba8Image& part = columns[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)];
            for (int row = 0; row < height; ++row)
                std::copy_n(part.row(row), 4 * width,
                            whole.row(y * (height + gap) + row) + 4 * x * (width + gap));
        }
    }
    return whole;
}

}  // namespace tessera
