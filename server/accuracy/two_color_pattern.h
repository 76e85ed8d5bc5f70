#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/math/footprint.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// A periodic picture of squares in two colours, a union of rectangles: its average over any polygon can be
/// written down. What filters are judged by comes from here, and shares no code with them.
struct TwoColorPattern {
    std::int32_t square_texels = 1;               ///< Side of a square.
    std::int32_t width = 1, height = 1;           ///< The period, in squares.
    std::vector<std::uint8_t> inked;              ///< width·height, 0 or 1; rows from the top.
    std::array<std::uint8_t, 3> ground{}, ink{};  ///< sRGB codes.
};

/// The pattern's period, texel by texel.
LinearImage draw(const TwoColorPattern& pattern);

/// The share of a footprint that is inked, exact but for rounding (some 10^−12): by Green's theorem the sum
/// over the footprint's edges of ∫ F dy, where F(x, y) is what lies between the footprint's own origin and x
/// in row y; each edge is cut where it crosses a square's border. Costs as much as the outline is long. A
/// footprint without area is its middle.
class InkIntegral {
  public:
    explicit InkIntegral(const TwoColorPattern& pattern);
    double share(const Footprint& footprint) const;

  private:
    struct Place {
        std::int64_t column = 0, row = 0;  ///< The square that holds the footprint's origin.
    };
    double along_edge(const Place& place, TexelPoint from, TexelPoint to) const;
    /// Inked squares of a row from column 0 to before `column`, of any sign.
    std::int64_t before(std::int64_t column, std::int64_t row) const noexcept;
    bool inked_at(std::int64_t column, std::int64_t row) const noexcept;

    std::int32_t square_texels_, width_, height_;
    std::vector<std::int32_t> sums_;  ///< height rows of width + 1.
};

}  // namespace tessera
