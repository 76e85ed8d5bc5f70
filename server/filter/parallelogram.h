#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/filter/convex_polygon.h"

namespace tessera {

/// A footprint in the coordinates of an image, whose texel (i, j) covers [i, i + 1) × [j, j + 1): a corner
/// and the two sides that start there.
struct Parallelogram {
    double x = 0, y = 0;
    double along_x = 0, along_y = 0;
    double across_x = 0, across_y = 0;
};

/// What a texel of an image weighs in an integral.
struct Tap {
    std::int32_t texel = 0;  ///< y·width + x
    double weight = 0;
};

/// Integrals of images over parallelograms, exact but for the rounding of doubles. The image is the surface
/// that interpolates bilinearly between the centres of texels, keeps the outermost texels' colours from their
/// centres to the border, and is 0 beyond the border. That surface is linear in the texels, so the integral
/// is a sum of weighted texels whose weights serve every image of a size.
///
/// The parallelogram is cut into the squares between four texel centres. There the surface is a bilinear
/// polynomial, and the moments 1, u, v and uv of each piece follow from its corners (Green's theorem: Steger,
/// "On the calculation of arbitrary moments of polygons", TU München FGBV-96-05, 1996). Only + − × ÷ on
/// doubles in a fixed order: the same bits everywhere.
class FootprintTaps {
  public:
    /// Of images of `width` × `height` texels, each 1 to 32768.
    FootprintTaps(std::int32_t width, std::int32_t height) : width_{width}, height_{height} {}

    /// Texels and weights, rows from the top; valid until the next call. The weights sum to the area of the
    /// footprint inside the image. Nothing for a footprint that misses the image, has no area, or whose
    /// numbers are not finite.
    std::span<const Tap> of(const Parallelogram& footprint);

  private:
    struct Moments {
        double area = 0, u = 0, v = 0, uv = 0;
    };

    static Moments moments(const ConvexPolygon& piece, double u, double v) noexcept;
    void add(std::int32_t i, std::int32_t j, const Moments& moments) noexcept;
    void add_strip(const ConvexPolygon& strip, std::int32_t j) noexcept;

    std::int32_t width_, height_;
    std::int32_t left_ = 0, top_ = 0, window_width_ = 0,
                 window_height_ = 0;  ///< Texels that may get a weight.
    std::vector<double> window_;
    std::vector<Tap> taps_;
};

}  // namespace tessera
