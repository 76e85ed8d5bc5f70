#pragma once

#include <array>
#include <cstdint>

namespace tessera {

/// The sRGB transfer function (IEC 61966-2-1) between 8-bit codes and linear light. Linear light is held in
/// steps of 1/65535: two neighbouring codes are at least 19 steps apart, so every code survives the way there
/// and back. The tables are made with +, −, ×, ÷ only, never libm, and are therefore the same on every
/// machine.

inline constexpr float linear_one = 65535.0F;  ///< 1.0 in steps

namespace detail {

/// x^2.4 for 0 < x ≤ 1: x² times the fifth root of x², by Newton's iteration.
constexpr double power_2_4(double x) {
    const double square = x * x;
    double root = 1.0;
    for (int i = 0; i < 64; ++i) root = (4.0 * root + square / (root * root * root * root)) / 5.0;
    return square * root;
}

/// Linear light, 0 to 1, of a possibly fractional code 0 to 255.
constexpr double decode(double code) {
    const double c = code / 255.0;
    return c <= 0.04045 ? c / 12.92 : power_2_4((c + 0.055) / 1.055);
}

constexpr std::array<std::uint16_t, 256> make_srgb_to_steps() {
    std::array<std::uint16_t, 256> table{};
    for (int code = 0; code < 256; ++code)
        table[static_cast<std::size_t>(code)] = static_cast<std::uint16_t>(decode(code) * 65535.0 + 0.5);
    return table;
}

}  // namespace detail

/// Linear steps of each sRGB code.
inline constexpr std::array<std::uint16_t, 256> srgb_to_steps = detail::make_srgb_to_steps();

/// The nearest sRGB code of each linear step: 64 KiB, built once.
const std::array<std::uint8_t, 65536>& steps_to_srgb() noexcept;
/// The same tables' first elements, for code that may call no inline function.
const std::uint8_t* steps_to_srgb_codes() noexcept;
const std::uint16_t* srgb_codes_to_steps() noexcept;

/// The nearest step of a linear value; values outside 0 to 1, and NaN, are clamped.
inline std::uint16_t to_steps(float linear) noexcept {
    const float scaled = linear * linear_one + 0.5F;
    return static_cast<std::uint16_t>(scaled > 0.0F ? (scaled < linear_one ? scaled : linear_one) : 0.0F);
}

/// Linear light 0 to 1 of an sRGB code.
inline float from_srgb(std::uint8_t code) noexcept {
    return static_cast<float>(srgb_to_steps[code]) / linear_one;
}

}  // namespace tessera
