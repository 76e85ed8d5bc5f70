#pragma once

#include <optional>

#include "client/residency/plane_view.h"
#include "client/view/hand/hand.h"

namespace tessera {

/// Between the picture's pixels and what hands point at: on the plane, where alone hands edit.
class HandPicture {
  public:
    explicit HandPicture(const PlaneView& view) : view_{view} {}

    /// What the pixel shows of the plane; nothing on the sky, or farther away than the extent's side.
    std::optional<HandPoint> point_at(double pixel_x, double pixel_y, Extent extent) const;

    struct Pixel {
        double x = 0, y = 0;
    };
    /// Where a point of the plane is in the picture, from the top-left corner; nothing behind the eye.
    std::optional<Pixel> pixel_of(const HandPoint& point) const;
    std::optional<Pixel> pixel_of(const HandPoint& point, const HandOffset& texels_away) const;

    /// The point under the eye, and how many texels above it that is.
    struct Eye {
        HandPoint below{};
        double height = 1;
    };
    Eye eye() const;

    /// How many texels a pixel covers around a pixel: across, where the plane is seen at a slant.
    double texels_per_pixel(double pixel_x, double pixel_y) const;

    /// A box around all of the plane that may be seen, no larger than the extent and a quarter around it.
    TexelBox seen(Extent extent) const;

  private:
    const PlaneView& view_;
};

}  // namespace tessera
