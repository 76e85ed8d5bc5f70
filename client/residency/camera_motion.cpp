#include "client/residency/camera_motion.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr double smoothing_ms = 60;
/// Faster is a leap, of which nothing follows: eye heights, or degrees, in one frame.
constexpr double leap_heights = 4, leap_degrees = 45;
/// Slower is rest.
constexpr double rest_heights = 1e-5, rest_degrees = 1e-4;  // a millisecond

double turned(double from, double to) { return std::remainder(to - from, 360.0); }

}  // namespace

void CameraMotion::observe(const Camera& camera, ClientTime now) {
    const double took = static_cast<double>((now - last_time_).count());
    if (is_known_ && took <= 0) return;
    const double height = std::max(last_.height_texels, 1e-9);
    const double x = distance_x(last_.ground, camera.ground) / height,
                 y = distance_y(last_.ground, camera.ground) / height;
    const double yaw = turned(last_.yaw_degrees, camera.yaw_degrees),
                 pitch = camera.pitch_degrees - last_.pitch_degrees;
    const double rise = std::log(camera.height_texels / height);
    const bool is_leap = !is_known_ || std::hypot(x, y) > leap_heights || std::abs(yaw) > leap_degrees ||
                         std::abs(pitch) > leap_degrees || std::abs(rise) > 1;
    if (is_leap) {
        speed_ = {};
    } else {
        const double weight = 1 - std::exp(-took / smoothing_ms);
        const auto follow = [&](double& speed, double moved) { speed += weight * (moved / took - speed); };
        follow(speed_.x, x);
        follow(speed_.y, y);
        follow(speed_.height, rise);
        follow(speed_.yaw, yaw);
        follow(speed_.pitch, pitch);
    }
    last_ = camera;
    last_time_ = now;
    is_known_ = true;
}

std::optional<Camera> CameraMotion::in(ClientTime ahead, Extent extent) const {
    if (std::hypot(speed_.x, speed_.y) < rest_heights && std::abs(speed_.height) < rest_heights &&
        std::hypot(speed_.yaw, speed_.pitch) < rest_degrees)
        return std::nullopt;
    const auto ms = static_cast<double>(ahead.count());
    Camera camera = last_;
    camera.yaw_degrees += speed_.yaw * ms;
    camera.pitch_degrees = std::clamp(last_.pitch_degrees + speed_.pitch * ms, -90.0, 89.0);
    camera.height_texels = last_.height_texels * std::exp(std::clamp(speed_.height * ms, -2.0, 2.0));
    camera.ground =
        last_.ground.moved(speed_.x * ms * last_.height_texels, speed_.y * ms * last_.height_texels);
    const std::int64_t end = extent.side_texels() - 1;
    camera.ground.x = std::clamp<std::int64_t>(camera.ground.x, 0, end);
    camera.ground.y = std::clamp<std::int64_t>(camera.ground.y, 0, end);
    return camera;
}

}  // namespace tessera
