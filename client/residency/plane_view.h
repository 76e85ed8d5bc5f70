#pragma once

#include <optional>

#include "client/residency/camera.h"

namespace tessera {

/// x east, y south, z up, in texels of level 0.
struct Vector3 {
    double x = 0;
    double y = 0;
    double z = 0;
};

/// A point of the plane relative to the point under the eye, in texels of level 0.
struct GroundPoint {
    double x = 0;
    double y = 0;
};

/// The plane as a camera sees it through `width`×`height` pixels. Pixel coordinates count from the top-left
/// corner of the picture; the middle of the first pixel is (0.5, 0.5).
class PlaneView {
  public:
    PlaneView(const Camera& camera, int width, int height);

    /// Where the pixel's ray meets the plane; nothing above the horizon.
    std::optional<GroundPoint> ground_at(double pixel_x, double pixel_y) const;

    /// The MIP level, fractional and unclamped, at which one texel is as large as the pixel's longer side on
    /// the plane: log2(max(|∂P/∂x|, |∂P/∂y|)), by exact derivatives. The shader has the same formula.
    /// The pixel's ray meets the plane.
    double level_at(double pixel_x, double pixel_y) const;

    const Camera& camera() const { return camera_; }
    int width() const { return width_; }
    int height() const { return height_; }
    const Vector3& forward() const { return forward_; }
    const Vector3& right() const { return right_; }
    const Vector3& up() const { return up_; }
    double tangent_x() const { return tangent_x_; }  ///< Of half the horizontal field of view.
    double tangent_y() const { return tangent_y_; }  ///< Of half the vertical field of view.
    /// Side of a pixel on the picture plane at distance 1.
    double pixel_step() const { return 2 * tangent_y_ / height_; }

  private:
    Vector3 ray(double pixel_x, double pixel_y) const;

    Camera camera_;
    int width_;
    int height_;
    Vector3 forward_, right_, up_;
    double tangent_x_, tangent_y_;
};

}  // namespace tessera
