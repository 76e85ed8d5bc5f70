#include "client/residency/plane_view.h"

#include <algorithm>
#include <numbers>

namespace tessera {

PlaneView::PlaneView(const Camera& camera, int width, int height)
    : camera_{camera}, width_{width}, height_{height} {
    constexpr double degree = std::numbers::pi / 180;
    const double yaw = camera.yaw_degrees * degree, pitch = camera.pitch_degrees * degree;
    const double sin_yaw = std::sin(yaw), cos_yaw = std::cos(yaw);
    const double sin_pitch = std::sin(pitch), cos_pitch = std::cos(pitch);
    forward_ = {sin_yaw * cos_pitch, -cos_yaw * cos_pitch, sin_pitch};
    right_ = {cos_yaw, sin_yaw, 0};
    up_ = {-sin_yaw * sin_pitch, cos_yaw * sin_pitch, cos_pitch};
    tangent_y_ = std::tan(camera.field_of_view_degrees * degree / 2);
    tangent_x_ = tangent_y_ * width / height;
}

Vector3 PlaneView::ray(double pixel_x, double pixel_y) const {
    const double across = (2 * pixel_x / width_ - 1) * tangent_x_;
    const double upwards = (1 - 2 * pixel_y / height_) * tangent_y_;
    return {forward_.x + across * right_.x + upwards * up_.x,
            forward_.y + across * right_.y + upwards * up_.y, forward_.z + upwards * up_.z};
}

std::optional<GroundPoint> PlaneView::ground_at(double pixel_x, double pixel_y) const {
    const Vector3 d = ray(pixel_x, pixel_y);
    if (!(d.z < 0)) return std::nullopt;
    const double reach = camera_.height_texels / -d.z;
    return GroundPoint{reach * d.x, reach * d.y};
}

double PlaneView::level_at(double pixel_x, double pixel_y) const {
    // With P = height · d.xy / fall, where fall = −d.z depends on the picture's row alone (no roll):
    // |∂P/∂x| = height · step / fall and |∂P/∂y| = height · step · √(1 + (across · cos pitch)²) / fall²
    const double fall = -ray(pixel_x, pixel_y).z;
    const double across = (2 * pixel_x / width_ - 1) * tangent_x_ * up_.z;
    const double footprint =
        camera_.height_texels * pixel_step() / fall * std::max(1.0, std::sqrt(1 + across * across) / fall);
    return std::log2(footprint);
}

}  // namespace tessera
