#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/math/footprint.h"
#include "shared/math/image_error.h"
#include "shared/page/texel_image.h"
#include "shared/situations/situation.h"

namespace tessera {

/// The true colour of footprints on an image that repeats for ever, whose texels are squares of one colour:
/// the area integral over the quadrilateral, in linear light, in closed form. The integral over an area is
/// one along its outline (Green): of the running sum of a line of texels, which is piecewise linear where the
/// outline crosses it, so that each crossing is integrated exactly by the sums' own running sums. What is
/// left is the rounding of doubles: a millionth of a code.
class AreaTruth {
  public:
    /// A square of side 2^k, opaque, at most 2048.
    explicit AreaTruth(const Rgba8Image& image);

    /// Linear light, 0 to 1, of a footprint that has an area.
    std::array<double, 3> mean(const Footprint& footprint) const;

  private:
    /// At a whole texel of a line: the sum of the 16-bit steps before it, and the integral of that sum so
    /// far.
    struct Sums {
        std::array<double, 3> integral{};
        std::array<std::uint32_t, 3> sum{};
    };
    const Sums* line(bool upright, std::int64_t index) const;
    std::array<double, 3> sum_at(const Sums* line, double y) const;
    std::array<double, 3> integral_at(const Sums* line, double y) const;
    void add_crossing(const Sums* line, double y0, double y1, double width,
                      std::array<double, 3>& integral) const;

    std::int32_t side_;
    std::array<std::vector<Sums>, 2> sums_;  ///< Along y, along x: side + 1 of each line
};

/// What a situation should show.
struct TruePicture {
    CodeImage codes;
    std::vector<float> linear;           ///< 3·width·height
    std::vector<std::uint8_t> measured;  ///< A flag for each pixel that has a footprint.
};

/// On all of the machine's threads.
TruePicture true_picture(const Situation& situation, const AreaTruth& texture);

}  // namespace tessera
