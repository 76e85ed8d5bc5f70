#pragma once

#include <cstdint>

namespace tessera {

/// The cosine and sine of an angle.
struct Turning {
    double cosine = 1;
    double sine = 0;
};

namespace detail {

/// Taylor's series for angles of 0 to π/4: what is left out is below 2^−60, rounding below 2^−51.
constexpr Turning small_turning(double angle) noexcept {
    const double square = angle * angle;
    double cosine = 1, sine = 1;
    for (int n = 18; n > 0; n -= 2) {
        cosine = 1 - square * cosine / static_cast<double>(n * (n - 1));
        sine = 1 - square * sine / static_cast<double>(n * (n + 1));
    }
    return {cosine, angle * sine};
}

}  // namespace detail

/// Of an angle given in turns, |turns| < 2^30. Made with + − × ÷ only, never libm, and therefore the same on
/// every machine. Exact at quarter turns, elsewhere within 2^−50.
constexpr Turning turning(double turns) noexcept {
    // Down to a quarter turn, then to an eighth: both without rounding
    const auto whole = static_cast<std::int64_t>(turns);
    double rest = turns - static_cast<double>(whole);
    if (rest < 0) rest += 1;
    const int quarter = static_cast<int>(rest * 4);
    rest = rest * 4 - quarter;
    constexpr double half_pi = 1.5707963267948966;
    Turning t =
        rest <= 0.5 ? detail::small_turning(rest * half_pi) : detail::small_turning((1 - rest) * half_pi);
    if (rest > 0.5) t = {t.sine, t.cosine};
    switch (quarter & 3) {
        case 1:
            return {-t.sine, t.cosine};
        case 2:
            return {-t.cosine, -t.sine};
        case 3:
            return {t.sine, -t.cosine};
        default:
            return t;
    }
}

/// The side, in whole texels, of the smallest square with sides along the axes that holds a square of
/// `side_texels`·`scale`, turned by `turns`; at least 1. What hangs over by less than a 2^20th of a texel is
/// cut.
constexpr std::int32_t bounding_side(std::int32_t side_texels, double scale, double turns) noexcept {
    const Turning t = turning(turns);
    const double cosine = t.cosine < 0 ? -t.cosine : t.cosine, sine = t.sine < 0 ? -t.sine : t.sine;
    const double extent = static_cast<double>(side_texels) * scale * (cosine + sine);
    const auto below = static_cast<std::int32_t>(extent);
    const std::int32_t side = extent - below > 0x1p-20 ? below + 1 : below;
    return side < 1 ? 1 : side;
}

}  // namespace tessera
