#pragma once

#include <optional>

#include "client/residency/plane_view.h"
#include "shared/page/page_key.h"

namespace tessera {

/// How the hands move the camera: along the plane, up and down, around, and to where the cursor points. Knows
/// no window. The camera stays above the extent, from 2 texels high up to twice the extent's side, and never
/// rolls.
class CameraControl {
  public:
    CameraControl(const Camera& start, Extent extent);

    const Camera& camera() const { return camera_; }
    void set(const Camera& camera);
    /// What there is to keep out of: the walls of a corridor. A terrain lifts the camera by itself.
    void set_surface(const Surface& surface);

    /// What is held down now, each −1 to 1; positive is forwards, right, up.
    struct Steering {
        double forwards = 0;
        double sideways = 0;
        double upwards = 0;
        bool fast = false;
    };
    /// Once a frame: steers, and carries on a zoom that has begun, both with a little inertia.
    void advance(double seconds, const Steering& steering);

    /// The plane follows the cursor: what was under (from_x, from_y) comes under (to_x, to_y). Pixels.
    void drag_plane(int width, int height, double from_x, double from_y, double to_x, double to_y);
    /// Turns the head.
    void look(double yaw_degrees, double pitch_degrees);
    /// Goes around the point in the middle of the picture, which stays there.
    void orbit(double yaw_degrees, double pitch_degrees);
    /// Comes nearer to the point under the cursor (positive steps) or leaves it.
    void zoom_at(int width, int height, double x, double y, double steps);
    void look_straight_down() { camera_.pitch_degrees = -90; }

  private:
    void approach(const GroundPoint& point, double factor);
    void keep_inside();
    double highest_pitch() const;

    Camera camera_;
    Extent extent_;
    Surface surface_{};
    double forwards_ = 0, sideways_ = 0, upwards_ = 0;  ///< Speeds, in heights (or doublings) a second
    double zoom_left_ = 0;                              ///< Of the zoom that has begun: log2 of height factor
    std::optional<PlanePoint> zoom_target_;
};

}  // namespace tessera
