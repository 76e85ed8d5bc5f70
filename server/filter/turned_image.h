#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/filter/parallelogram.h"
#include "server/filter/turning.h"

namespace tessera {

/// How an image is turned, scaled and put into another one.
struct ImagePlacement {
    std::int32_t side = 1;                  ///< Of the image, in its own texels.
    double scale = 1;                       ///< Texels of the result for one of the image's.
    double turns = 0;                       ///< From x towards y: clockwise where y points down.
    std::int32_t width = 1;                 ///< Of the result, which is a square.
    double middle_x = 0.5, middle_y = 0.5;  ///< Where the image's middle lies in the result.
};

/// Images of one size, turned, scaled and moved: a texel of the result is the exact integral of the image's
/// bilinear surface over it (parallelogram.h), transparent outside. Where texels fall on texels they are
/// copied. Weights are found once for a row and serve every image.
class TurnedImage {
  public:
    explicit TurnedImage(const ImagePlacement& placement);

    /// The row that sum() makes, from 0 on.
    void set_row(std::int32_t y);

    /// `image`: side² texels of four steps, premultiplied, rows from the top. `out`: 4·width steps.
    void sum(const std::uint16_t* image, std::uint16_t* out) const noexcept;

  private:
    /// What the image's columns, or its rows, weigh in a stretch of its axis.
    struct Stretch {
        std::int32_t first = 0;
        std::size_t from = 0, to = 0;  ///< Of axis_weights_.
    };
    void cut_axes();
    Stretch stretch(double from, double to);
    void set_straight_row(std::int32_t y);

    ImagePlacement placement_;
    double cosine_, sine_;  ///< Divided by the scale: from the result back into the image.
    bool onto_texels_;
    FootprintTaps footprints_;
    std::vector<Tap> taps_;
    std::vector<std::size_t> from_;  ///< Of each texel's taps, and behind the last.
    /// Of footprints along the axes whose weights are exact: products of each column's and row's.
    std::vector<Stretch> columns_, rows_;
    std::vector<double> axis_weights_;
};

}  // namespace tessera
