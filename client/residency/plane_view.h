#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "client/residency/camera.h"
#include "client/residency/flat_piece.h"
#include "client/residency/sampling.h"

namespace tessera {

/// A point of the texture relative to the point under the eye, in texels of level 0.
struct GroundPoint {
    double x = 0;
    double y = 0;
};

/// A surface as a camera sees it through `width`×`height` pixels. Pixel coordinates count from the top-left
/// corner of the picture; the middle of the first pixel is (0.5, 0.5).
class PlaneView {
  public:
    PlaneView(const Camera& camera, int width, int height, const Surface& surface = {});

    /// The same picture from another camera.
    PlaneView from(const Camera& camera) const;
    /// Of the same picture, only these columns of pixels are of interest: [first, end), at least one.
    PlaneView part(int first_column, int end_column) const;
    /// Pixels from this column on are sampled so; those before it otherwise.
    PlaneView split_at(int column, const Sampling& right) const;

    /// Whether all of it is the same, so that it reads the same pages.
    bool is_same(const PlaneView& other) const;

    int first_column() const { return first_column_; }
    int end_column() const { return end_column_; }
    struct Split {
        int column = 0;
        Sampling right{};
        bool operator==(const Split&) const = default;
    };
    const std::optional<Split>& split() const { return split_; }

    /// Which point of the texture the pixel's ray meets; nothing above the horizon.
    std::optional<GroundPoint> ground_at(double pixel_x, double pixel_y) const;

    /// The MIP level, fractional and unclamped, at which one texel is as large as the pixel's longer side on
    /// the surface: log2(max(|∂P/∂x|, |∂P/∂y|)), by exact derivatives. The shader has the same formula.
    /// The pixel's ray meets the surface.
    double level_at(double pixel_x, double pixel_y) const;

    const Camera& camera() const { return camera_; }
    int width() const { return width_; }
    int height() const { return height_; }
    const Surface& surface() const { return surface_; }
    bool is_plane() const { return surface_.kind == Surface::Kind::plane; }
    /// What may be in the picture, flat piece by flat piece; the plane is one.
    const std::vector<FlatPiece>& pieces() const { return *pieces_; }
    /// The piece that the pixel's ray meets first; none above the horizon.
    const FlatPiece* piece_at(double pixel_x, double pixel_y) const;
    /// How high the eye is above z = 0: the camera's height, and that of the surface under it.
    double eye_height() const { return eye_height_; }

    const Vector3& forward() const { return forward_; }
    const Vector3& right() const { return right_; }
    const Vector3& up() const { return up_; }
    double tangent_x() const { return tangent_x_; }  ///< Of half the horizontal field of view.
    double tangent_y() const { return tangent_y_; }  ///< Of half the vertical field of view.
    /// Side of a pixel on the picture plane at distance 1.
    double pixel_step() const { return 2 * tangent_y_ / height_; }

  private:
    std::shared_ptr<const std::vector<FlatPiece>> pieces_of_frame() const;

    Camera camera_;
    int width_;
    int height_;
    Surface surface_;
    int first_column_ = 0, end_column_;
    std::optional<Split> split_;
    double eye_height_ = 0;
    Vector3 forward_, right_, up_;
    double tangent_x_, tangent_y_;
    std::shared_ptr<const std::vector<FlatPiece>> pieces_;
};

/// Which texel a point of the piece's plane has; `point` from the eye, anywhere on the plane.
GroundPoint texel_at(const FlatPiece& piece, const PlaneView& view, const Vector3& point);

}  // namespace tessera
