#pragma once

#include <algorithm>
#include <cmath>

namespace tessera {

/// What a filter reads for a pixel, as far as pages go. The shaders have the same formulas.
struct Sampling {
    enum class Kind {
        isotropic,      ///< The two levels around the footprint's longer side.
        nearest_level,  ///< The nearer of these two.
        anisotropic,  ///< The two levels around its shorter side, at most 16 times finer than the longer one.
        driver_anisotropic,  ///< These levels, but only the page that the footprint's middle lies in.
        supersampled,        ///< The pixel in parts, each by the two levels around its own longer side.
        line_integral,       ///< One level, by the width and length of the footprint's bounding box.
    };
    Kind kind = Kind::isotropic;
    int subdivisions = 1;  ///< Of supersampled: so many parts a side.
    int columns = 6;       ///< Of line_integral: at most so many across a footprint.
    bool operator==(const Sampling&) const = default;
};

inline constexpr double most_anisotropy = 16;

/// How wide a column is, in texels, of a line integral over a footprint whose bounding box is `across` by
/// `along` texels, `across` the shorter; its level is the binary logarithm of that, rounded up.
/// line_integral.glsl says why.
inline double line_integral_column(double across, double along, double most_columns) {
    constexpr double most_pieces = 40, page_side = 256;
    const double pages = along / (across * page_side);
    const double columns =
        std::min(most_columns, 2 * most_pieces / (1 + std::sqrt(1 + 4 * most_pieces * pages)));
    return across / columns;
}

}  // namespace tessera
