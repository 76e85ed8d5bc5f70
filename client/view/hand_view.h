#pragma once

#include <optional>

#include "client/residency/plane_view.h"
#include "client/view/hand/hand.h"
#include "client/view/picture_pieces.h"

namespace tessera {

/// Between the picture's pixels and what hands point at, on whatever the texture lies.
class HandPicture {
  public:
    explicit HandPicture(const PlaneView& view) : view_{view} {}
    const PlaneView& view() const { return view_; }

    /// What the pixel shows of the texture, as the read-out says it; nothing on the sky, or farther away than
    /// the extent's side.
    std::optional<HandPoint> point_at(double pixel_x, double pixel_y, Extent extent) const;

    /// On how many sheets a point may be seen: more than one in a corridor (PicturePieces::sheets).
    int sheets() const { return PicturePieces::sheets(view_.surface()); }
    /// Whether lines of the texture are straight in the picture, and what is before the eye is seen.
    bool is_plane() const { return view_.is_plane(); }

    using Pixel = PicturePieces::Pixel;
    /// Where a point of the texture is in the picture, from the top-left corner. Nothing behind the eye; off
    /// a plane also where something hides it, and more than a little beside the picture.
    std::optional<Pixel> pixel_of(const HandPoint& point, int sheet = 0) const;
    std::optional<Pixel> pixel_of(const HandPoint& point, const HandOffset& texels_away, int sheet = 0) const;

    /// The point under the eye, and how many texels above it that is.
    struct Eye {
        HandPoint below{};
        double height = 1;
    };
    Eye eye() const;

    /// How many texels a pixel covers around a pixel: across, where the surface is seen at a slant; 1 on the
    /// sky.
    double texels_per_pixel(double pixel_x, double pixel_y) const;

    /// A box around all of the texture that may be seen and is near enough to be taken hold of, no larger
    /// than the extent and a quarter around it.
    TexelBox seen(Extent extent) const;

  private:
    const PicturePieces& pieces() const;

    PlaneView view_;
    mutable std::optional<PicturePieces>
        pieces_;  ///< Made when first asked for: most pictures show no hands.
};

}  // namespace tessera
