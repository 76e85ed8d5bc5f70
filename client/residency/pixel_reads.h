#pragma once

#include <array>
#include <vector>

#include "client/residency/plane_view.h"
#include "client/residency/sampling.h"
#include "shared/page/page_key.h"

namespace tessera {

using Quadrilateral = std::array<GroundPoint, 4>;  ///< Convex, its corners in order.

/// Which pages the shaders read for a pixel of a flat piece, by their own formulas (client/render/shaders),
/// in doubles. Where a float might fall on the other side of a border, both sides count.
class PixelReads {
  public:
    /// The clip centre of `view` lies inside the extent. `view` outlives this. Of its first piece, at first.
    PixelReads(const PlaneView& view, Extent extent, double lod_bias, const Sampling& sampling);

    /// From now on, of this piece, which outlives that.
    void look_at(const FlatPiece& piece);

    /// The pixel's middle sees the piece's plane, before its horizon.
    bool sees_plane(int x, int y) const { return nearness(x + 0.5, y + 0.5) > 0; }

    /// Adds the pages that pixel (x, y) reads, some perhaps twice; it sees the piece's plane.
    void add_pages(int x, int y, std::vector<PageKey>& pages) const;

    /// What pixels in [left, right) × [top, bottom) may read, at most a bit too much; all see the piece's
    /// plane.
    struct Bounds {
        int finest = 0;  ///< Levels, clamped to the extent's
        int coarsest = 0;
        Quadrilateral ground{};
    };
    Bounds bounds(int left, int top, int right, int bottom) const;
    /// Whether one of these pixels may read the page.
    bool may_read(int left, int top, int right, int bottom, PageKey page) const;
    /// Part of the picture, in pixels.
    struct Part {
        double left = -1e9, top = -1e9, right = 1e9, bottom = 1e9;
    };
    /// All pixels that read the page of the piece's plane lie in this part, if any does.
    Part part_of(PageKey page) const;
    /// Adds the pages of a level that a quadrilateral of the plane meets. False if these are more than any
    /// window holds in a row: none is added then.
    bool add_pages(const Quadrilateral& ground, int level, std::vector<PageKey>& pages) const;

  private:
    struct Range {
        double low = 0, high = 0;
    };
    /// A pixel's middle and sides on the plane.
    struct Footprint {
        GroundPoint middle, dx, dy;
        double longer = 0, shorter = 0;
    };
    /// A page's, counted from the clip centre.
    struct Square {
        double left = 0, top = 0, side = 0;
    };
    Square square_of(PageKey page) const;
    double nearness(double x, double y) const;
    GroundPoint ground(double x, double y, double least_nearness) const;
    Footprint footprint(double x, double y) const;
    Quadrilateral pixel_corners(double x, double y, double half) const;
    Quadrilateral ground_of(int left, int top, int right, int bottom, int coarsest) const;
    Range levels(int left, int top, int right, int bottom) const;
    Range line_integral_levels(double first_x, double first_y, double last_x, double last_y) const;
    double line_level(const Quadrilateral& corners) const;
    void add_page(GroundPoint at, int level, std::vector<PageKey>& pages) const;
    bool is_around(GroundPoint at, GroundPoint reach, int level, bool* surely) const;
    void add_probes(const Footprint& footprint, double probes, GroundPoint side, int level,
                    std::vector<PageKey>& pages) const;
    void add_anisotropic(const Footprint& footprint, std::vector<PageKey>& pages) const;
    void add_supersampled(const Footprint& footprint, double x, double y, std::vector<PageKey>& pages) const;
    void add_line_integral(const Footprint& footprint, double x, double y, std::vector<PageKey>& pages) const;
    int clamped(double level) const;

    /// The eye's page of each level, and where in it the eye is, in texels of level 0.
    struct Origin {
        std::int64_t page_x = 0, page_y = 0;
        double within_x = 0, within_y = 0;
    };
    /// From texels to the picture: the inverse of the piece's rows s, t, w, by columns, but for a factor > 0.
    struct ToPicture {
        Vector3 x, y, one;
    };
    const PlaneView& view_;
    const FlatPiece* piece_ = nullptr;
    ToPicture to_picture_{};
    Extent extent_;
    double lod_bias_;
    double low_scale_, high_scale_;  ///< Of lengths: the bias, and less or more what floats may be off
    Sampling sampling_;
    std::array<Origin, max_level + 1> origins_{};
};

}  // namespace tessera
