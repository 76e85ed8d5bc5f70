#include "client/residency/plane_view.h"

#include <algorithm>
#include <numbers>

namespace tessera {
namespace {

double at(const std::array<double, 3>& row, double x, double y) { return row[0] * x + row[1] * y + row[2]; }

/// Whether a ray meets a convex polygon: it passes all its sides on one hand.
bool meets(const Vector3& ray, const FlatPiece& piece) {
    int left = 0, right = 0;
    for (int i = 0; i < piece.corner_count; ++i) {
        const auto& a = piece.corners[static_cast<std::size_t>(i)];
        const auto& b = piece.corners[static_cast<std::size_t>((i + 1) % piece.corner_count)];
        const double side = dot(ray, cross(a, b));
        if (side > 0) ++left;
        if (side < 0) ++right;
    }
    return left == 0 || right == 0;
}

}  // namespace

PlaneView::PlaneView(const Camera& camera, int width, int height, const Surface& surface)
    : camera_{camera},
      width_{width},
      height_{height},
      surface_{surface},
      end_column_{width},
      eye_height_{camera.height_texels + base_height(surface, camera.ground)} {
    constexpr double degree = std::numbers::pi / 180;
    const double yaw = camera.yaw_degrees * degree, pitch = camera.pitch_degrees * degree;
    const double sin_yaw = std::sin(yaw), cos_yaw = std::cos(yaw);
    const double sin_pitch = std::sin(pitch), cos_pitch = std::cos(pitch);
    forward_ = {sin_yaw * cos_pitch, -cos_yaw * cos_pitch, sin_pitch};
    right_ = {cos_yaw, sin_yaw, 0};
    up_ = {-sin_yaw * sin_pitch, cos_yaw * sin_pitch, cos_pitch};
    tangent_y_ = std::tan(camera.field_of_view_degrees * degree / 2);
    tangent_x_ = tangent_y_ * width / height;
    pieces_ = pieces_of_frame();
}

/// A frame makes the same view several times, and hills are thousands of pieces.
std::shared_ptr<const std::vector<FlatPiece>> PlaneView::pieces_of_frame() const {
    struct Made {
        Camera camera;
        int width = 0, height = 0;
        Surface surface;
        std::shared_ptr<const std::vector<FlatPiece>> pieces;
    };
    thread_local Made last;
    if (!last.pieces || !(last.camera == camera_) || last.width != width_ || last.height != height_ ||
        !(last.surface == surface_))
        last = {camera_, width_, height_, surface_,
                std::make_shared<const std::vector<FlatPiece>>(pieces_of(surface_, *this))};
    return last.pieces;
}

PlaneView PlaneView::from(const Camera& camera) const {
    PlaneView made{camera, width_, height_, surface_};
    made.first_column_ = first_column_;
    made.end_column_ = end_column_;
    made.split_ = split_;
    return made;
}

PlaneView PlaneView::part(int first_column, int end_column) const {
    PlaneView made = *this;
    made.first_column_ = first_column;
    made.end_column_ = end_column;
    made.split_.reset();
    return made;
}

PlaneView PlaneView::split_at(int column, const Sampling& right) const {
    PlaneView made = *this;
    made.split_ = Split{column, right};
    return made;
}

const FlatPiece* PlaneView::piece_at(double pixel_x, double pixel_y) const {
    const double x = pixel_x - width_ / 2.0, y = pixel_y - height_ / 2.0;
    const double across = x * pixel_step(), upwards = -y * pixel_step();
    const Vector3 ray{forward_.x + across * right_.x + upwards * up_.x,
                      forward_.y + across * right_.y + upwards * up_.y, forward_.z + upwards * up_.z};
    const FlatPiece* nearest = nullptr;
    double nearest_w = 0;
    for (const FlatPiece& piece : *pieces_) {
        const double w = at(piece.w, x, y);
        if (w <= nearest_w || !meets(ray, piece)) continue;
        nearest = &piece;
        nearest_w = w;
    }
    return nearest;
}

std::optional<GroundPoint> PlaneView::ground_at(double pixel_x, double pixel_y) const {
    const FlatPiece* piece = piece_at(pixel_x, pixel_y);
    if (!piece) return std::nullopt;
    const double x = pixel_x - width_ / 2.0, y = pixel_y - height_ / 2.0;
    const double w = at(piece->w, x, y);
    return GroundPoint{at(piece->s, x, y) / w, at(piece->t, x, y) / w};
}

double PlaneView::level_at(double pixel_x, double pixel_y) const {
    const FlatPiece* piece = piece_at(pixel_x, pixel_y);
    if (!piece) return 0;
    // P = (S, T) / W, each linear in the pixel: ∂P = (∂(S, T) − P·∂W) / W
    const double x = pixel_x - width_ / 2.0, y = pixel_y - height_ / 2.0;
    const double w = at(piece->w, x, y);
    const GroundPoint p{at(piece->s, x, y) / w, at(piece->t, x, y) / w};
    const auto side = [&](std::size_t axis) {
        return std::hypot(piece->s[axis] - p.x * piece->w[axis], piece->t[axis] - p.y * piece->w[axis]) / w;
    };
    return std::log2(std::max(side(0), side(1)));
}

GroundPoint texel_at(const FlatPiece& piece, const PlaneView& view, const Vector3& point) {
    // The point's place in the picture times its depth: w is 1 there
    const double x = dot(point, view.right()) / view.pixel_step(),
                 y = -dot(point, view.up()) / view.pixel_step(), depth = dot(point, view.forward());
    const auto along = [&](const std::array<double, 3>& row) {
        return row[0] * x + row[1] * y + row[2] * depth;
    };
    return {along(piece.s), along(piece.t)};
}

bool PlaneView::is_same(const PlaneView& other) const {
    return camera_ == other.camera_ && width_ == other.width_ && height_ == other.height_ &&
           surface_ == other.surface_ && first_column_ == other.first_column_ &&
           end_column_ == other.end_column_ && split_ == other.split_;
}

}  // namespace tessera
