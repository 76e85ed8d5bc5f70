#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/rgb8_image.h"

namespace tessera {

/// A colour as the eye tells them apart: CIELAB (D65) in eighths of a unit, in integers from beginning to
/// end, so that no decision depends on a compiler or a libm.
struct PerceptualColor {
    std::int16_t lightness = 0;  ///< 0 to 800
    std::int16_t green_red = 0;  ///< about ±800
    std::int16_t blue_yellow = 0;
    bool operator==(const PerceptualColor&) const = default;
};

/// The squared distance of two colours, in 64ths of a squared CIELAB unit.
constexpr std::int32_t difference(PerceptualColor a, PerceptualColor b) noexcept {
    const std::int32_t l = a.lightness - b.lightness;
    const std::int32_t g = a.green_red - b.green_red;
    const std::int32_t y = a.blue_yellow - b.blue_yellow;
    return l * l + g * g + y * y;
}

/// The distance of two colours in 32nds of a CIELAB unit, rounded down: below 2^14.
std::uint32_t color_distance(PerceptualColor a, PerceptualColor b) noexcept;

/// An image of such colours, rows from the top.
struct PerceptualImage {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<PerceptualColor> colors;

    const PerceptualColor& at(std::int32_t x, std::int32_t y) const noexcept {
        return colors[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

PerceptualImage to_perceptual(const Rgb8Image& image);

/// Means of `factor`×`factor` blocks from the top-left corner on; what is left at right and bottom is
/// dropped.
PerceptualImage reduced(const PerceptualImage& image, std::int32_t factor);

}  // namespace tessera
