#include "client/view/camera_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tessera {
namespace {

constexpr double least_height = 2;
constexpr double lowest_pitch = -90, highest_pitch_on_plane = 20;
constexpr double speed = 1.1;             ///< Eye heights a second
constexpr double fast_speed = 5;          ///< Times that
constexpr double climb = 1.2;             ///< Doublings of the height a second
constexpr double inertia_seconds = 0.12;  ///< Until a change of speed is two thirds done
constexpr double zoom_step = 0.3;         ///< Doublings for each step of the wheel
constexpr double degree = std::numbers::pi / 180;

}  // namespace

CameraControl::CameraControl(const Camera& start, Extent extent) : camera_{start}, extent_{extent} {
    keep_inside();
}

void CameraControl::set(const Camera& camera) {
    camera_ = camera;
    forwards_ = sideways_ = upwards_ = zoom_left_ = 0;
    zoom_target_.reset();
    keep_inside();
}

void CameraControl::set_surface(const Surface& surface) {
    surface_ = surface;
    keep_inside();
}

void CameraControl::advance(double seconds, const Steering& steering) {
    const double blend = 1 - std::exp(-seconds / inertia_seconds);
    const double fastness = steering.fast ? fast_speed : 1;
    forwards_ += blend * (steering.forwards * speed * fastness - forwards_);
    sideways_ += blend * (steering.sideways * speed * fastness - sideways_);
    upwards_ += blend * (steering.upwards * climb * (steering.fast ? 2 : 1) - upwards_);
    const double yaw = camera_.yaw_degrees * degree, stride = camera_.height_texels * seconds;
    camera_.ground = camera_.ground.moved(stride * (forwards_ * std::sin(yaw) + sideways_ * std::cos(yaw)),
                                          stride * (-forwards_ * std::cos(yaw) + sideways_ * std::sin(yaw)));
    camera_.height_texels *= std::exp2(upwards_ * seconds);
    if (zoom_target_) {
        const double now = std::abs(zoom_left_) < 0.005 ? zoom_left_ : zoom_left_ * blend;
        zoom_left_ -= now;
        approach({distance_x(camera_.ground, *zoom_target_), distance_y(camera_.ground, *zoom_target_)},
                 std::exp2(now));
        if (zoom_left_ == 0) zoom_target_.reset();
    }
    keep_inside();
}

void CameraControl::drag_plane(int width, int height, double from_x, double from_y, double to_x,
                               double to_y) {
    const PlaneView view{camera_, width, height};
    const auto from = view.ground_at(from_x, from_y), to = view.ground_at(to_x, to_y);
    if (!from || !to) return;
    // Near the horizon a pixel is a mile: no farther than some eye heights at once
    const double limit = 4 * camera_.height_texels;
    camera_.ground = camera_.ground.moved(std::clamp(from->x - to->x, -limit, limit),
                                          std::clamp(from->y - to->y, -limit, limit));
    keep_inside();
}

void CameraControl::look(double yaw_degrees, double pitch_degrees) {
    camera_.yaw_degrees = std::remainder(camera_.yaw_degrees + yaw_degrees, 360);
    camera_.pitch_degrees = std::clamp(camera_.pitch_degrees + pitch_degrees, lowest_pitch, highest_pitch());
}

void CameraControl::orbit(double yaw_degrees, double pitch_degrees) {
    // The middle of the picture lies height / tan(−pitch) ahead; keep its distance from the eye
    const double pitch = std::min(camera_.pitch_degrees, -3.0) * degree, yaw = camera_.yaw_degrees * degree;
    const double distance = camera_.height_texels / -std::sin(pitch);
    const double ahead = distance * std::cos(pitch);
    const PlanePoint centre = camera_.ground.moved(ahead * std::sin(yaw), -ahead * std::cos(yaw));
    look(yaw_degrees, pitch_degrees);
    camera_.pitch_degrees = std::min(camera_.pitch_degrees, -3.0);
    const double new_pitch = camera_.pitch_degrees * degree, new_yaw = camera_.yaw_degrees * degree;
    const double new_ahead = distance * std::cos(new_pitch);
    camera_.ground = centre.moved(-new_ahead * std::sin(new_yaw), new_ahead * std::cos(new_yaw));
    camera_.height_texels = -distance * std::sin(new_pitch);
    keep_inside();
}

void CameraControl::zoom_at(int width, int height, double x, double y, double steps) {
    const PlaneView view{camera_, width, height};
    auto ground = view.ground_at(x, y);
    const double limit = 12 * camera_.height_texels;
    if (!ground || std::hypot(ground->x, ground->y) > limit) ground = GroundPoint{};
    zoom_target_ = camera_.ground.moved(ground->x, ground->y);
    zoom_left_ = std::clamp(zoom_left_ - steps * zoom_step, -12.0, 12.0);
}

/// Scales the eye's distance to a point of the plane, so that the point stays where it is in the picture.
void CameraControl::approach(const GroundPoint& point, double factor) {
    const double highest = 2 * static_cast<double>(extent_.side_texels());
    const double height = std::clamp(camera_.height_texels * factor, least_height, highest);
    const double kept = height / camera_.height_texels;
    camera_.ground = camera_.ground.moved(point.x * (1 - kept), point.y * (1 - kept));
    camera_.height_texels = height;
}

void CameraControl::keep_inside() {
    const std::int64_t last = extent_.side_texels() - 1;
    const auto inside = [&](std::int64_t& texel, double& fraction) {
        if (texel < 0) texel = 0, fraction = 0;
        if (texel > last) texel = last, fraction = 0;
    };
    inside(camera_.ground.x, camera_.ground.fraction_x);
    inside(camera_.ground.y, camera_.ground.fraction_y);
    if (surface_.kind == Surface::Kind::corridor) {
        const double room = 0.93 * surface_.half_side;
        const PlanePoint middle{surface_.middle_x, camera_.ground.y, 0, camera_.ground.fraction_y};
        const double aside = distance_x(middle, camera_.ground);
        if (std::abs(aside) > room) camera_.ground = middle.moved(std::copysign(room, aside), 0);
        camera_.height_texels =
            std::clamp(camera_.height_texels, surface_.half_side - room, surface_.half_side + room);
    }
    camera_.height_texels =
        std::clamp(camera_.height_texels, least_height, 2 * static_cast<double>(extent_.side_texels()));
    camera_.pitch_degrees = std::clamp(camera_.pitch_degrees, lowest_pitch, highest_pitch());
}

/// There is more to see above than sky.
double CameraControl::highest_pitch() const {
    return surface_.kind == Surface::Kind::plane ? highest_pitch_on_plane : 75;
}

}  // namespace tessera
