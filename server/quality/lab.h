#pragma once

#include <cmath>
#include <cstdint>

namespace tessera {

/// A colour of CIELAB over D65 white: lightness 0 to 100, the others about ±128.
struct Lab {
    float lightness = 0, green_red = 0, blue_yellow = 0;
};

/// Of an sRGB-coded colour: three codes.
Lab to_lab(const std::uint8_t* codes) noexcept;

/// Its lightness alone.
float lightness_of(const std::uint8_t* codes) noexcept;

/// How far two colours look apart, in units of CIELAB (CIE 1976).
inline float difference(const Lab& a, const Lab& b) noexcept {
    const float l = a.lightness - b.lightness;
    const float g = a.green_red - b.green_red;
    const float y = a.blue_yellow - b.blue_yellow;
    return std::sqrt(l * l + g * g + y * y);
}
inline float difference(const std::uint8_t* a, const std::uint8_t* b) noexcept {
    return difference(to_lab(a), to_lab(b));
}

}  // namespace tessera
