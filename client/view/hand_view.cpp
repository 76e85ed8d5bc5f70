#include "client/view/hand_view.h"

#include <algorithm>
#include <cmath>

namespace tessera {

std::optional<HandPoint> HandPicture::point_at(double pixel_x, double pixel_y, Extent extent) const {
    const auto ground = view_.ground_at(pixel_x, pixel_y);
    const auto side = static_cast<double>(extent.side_texels());
    if (!ground || std::abs(ground->x) > side || std::abs(ground->y) > side) return std::nullopt;
    return hand_point(view_.camera().ground.moved(ground->x, ground->y));
}

const PicturePieces& HandPicture::pieces() const {
    if (!pieces_) pieces_.emplace(view_);
    return *pieces_;
}

std::optional<HandPicture::Pixel> HandPicture::pixel_of(const HandPoint& point, int sheet) const {
    return pixel_of(point, {}, sheet);
}

std::optional<HandPicture::Pixel> HandPicture::pixel_of(const HandPoint& point, const HandOffset& texels_away,
                                                        int sheet) const {
    const PlanePoint at = plane_point(point);
    const double x = distance_x(view_.camera().ground, at) + texels_away.x,
                 y = distance_y(view_.camera().ground, at) + texels_away.y, z = -view_.camera().height_texels;
    if (!view_.is_plane()) return pieces().pixel_of(x, y, sheet);
    const auto along = [&](const Vector3& axis) { return x * axis.x + y * axis.y + z * axis.z; };
    const double depth = along(view_.forward());
    if (depth < 1e-6 * view_.camera().height_texels) return std::nullopt;
    return Pixel{(along(view_.right()) / depth / view_.tangent_x() + 1) * view_.width() / 2,
                 (1 - along(view_.up()) / depth / view_.tangent_y()) * view_.height() / 2};
}

HandPicture::Eye HandPicture::eye() const {
    return {hand_point(view_.camera().ground), view_.camera().height_texels};
}

double HandPicture::texels_per_pixel(double pixel_x, double pixel_y) const {
    const FlatPiece* piece = view_.piece_at(pixel_x, pixel_y);
    if (!piece) return 1;
    // As PlaneView::level_at does, of the shorter side
    const double x = pixel_x - view_.width() / 2.0, y = pixel_y - view_.height() / 2.0;
    const auto along = [&](const std::array<double, 3>& row) { return row[0] * x + row[1] * y + row[2]; };
    const double w = along(piece->w), s = along(piece->s) / w, t = along(piece->t) / w;
    const auto side = [&](std::size_t axis) {
        return std::hypot(piece->s[axis] - s * piece->w[axis], piece->t[axis] - t * piece->w[axis]) / w;
    };
    return std::clamp(std::min(side(0), side(1)), 1e-6, 1e12);
}

TexelBox HandPicture::seen(Extent extent) const {
    const PlanePoint& origin = view_.camera().ground;
    const auto side = static_cast<double>(extent.side_texels());
    // What is farther away is too small to be taken hold of
    const double reach = std::min(side, 60 * std::max(view_.camera().height_texels, view_.eye_height()));
    double left = 0, right = 0, top = 0, bottom = 0;
    const auto take_in = [&](double x, double y) {
        left = std::min(left, std::max(x, -reach));
        right = std::max(right, std::min(x, reach));
        top = std::min(top, std::max(y, -reach));
        bottom = std::max(bottom, std::min(y, reach));
    };
    const auto width = static_cast<double>(view_.width()), height = static_cast<double>(view_.height());
    if (!view_.is_plane()) {
        const BoxTree::Box around = texels_of(view_);
        if (around.left <= around.right) {
            take_in(around.left, around.top);
            take_in(around.right, around.bottom);
        }
    } else {
        // Along the picture's edge and some rows down
        for (const double y : {0.0, 0.1, 0.2, 0.3, 0.5, 1.0})
            for (const double x : {0.0, 0.5, 1.0})
                if (const auto at = view_.ground_at(x * width, y * height)) take_in(at->x, at->y);
    }
    return {origin.x + static_cast<std::int64_t>(std::floor(left)),
            origin.y + static_cast<std::int64_t>(std::floor(top)),
            origin.x + static_cast<std::int64_t>(std::ceil(right)) + 1,
            origin.y + static_cast<std::int64_t>(std::ceil(bottom)) + 1};
}

}  // namespace tessera
