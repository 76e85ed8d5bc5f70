#include "client/view/hand_view.h"

#include <algorithm>
#include <cmath>

namespace tessera {

std::optional<HandPoint> HandPicture::point_at(double pixel_x, double pixel_y, Extent extent) const {
    if (!view_.is_plane()) return std::nullopt;
    const auto ground = view_.ground_at(pixel_x, pixel_y);
    const auto side = static_cast<double>(extent.side_texels());
    if (!ground || std::abs(ground->x) > side || std::abs(ground->y) > side) return std::nullopt;
    return hand_point(view_.camera().ground.moved(ground->x, ground->y));
}

std::optional<HandPicture::Pixel> HandPicture::pixel_of(const HandPoint& point) const {
    return pixel_of(point, {});
}

std::optional<HandPicture::Pixel> HandPicture::pixel_of(const HandPoint& point,
                                                        const HandOffset& texels_away) const {
    if (!view_.is_plane()) return std::nullopt;
    const PlanePoint at = plane_point(point);
    const double x = distance_x(view_.camera().ground, at) + texels_away.x,
                 y = distance_y(view_.camera().ground, at) + texels_away.y, z = -view_.camera().height_texels;
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
    const auto left = view_.ground_at(pixel_x - 1, pixel_y), right = view_.ground_at(pixel_x + 1, pixel_y);
    if (!left || !right) return 1;
    return std::max(std::hypot(right->x - left->x, right->y - left->y) / 2, 1e-6);
}

TexelBox HandPicture::seen(Extent extent) const {
    const PlanePoint& origin = view_.camera().ground;
    const auto side = static_cast<double>(extent.side_texels());
    double left = 0, right = 0, top = 0, bottom = 0;
    const auto width = static_cast<double>(view_.width()), height = static_cast<double>(view_.height());
    // Along the picture's edge and some rows down: what is far away is too small to be taken hold of
    for (const double y : {0.0, 0.1, 0.2, 0.3, 0.5, 1.0})
        for (const double x : {0.0, 0.5, 1.0}) {
            const auto at = view_.ground_at(x * width, y * height);
            if (!at) continue;
            const double reach = std::min(side, 60 * view_.camera().height_texels);
            left = std::min(left, std::max(at->x, -reach));
            right = std::max(right, std::min(at->x, reach));
            top = std::min(top, std::max(at->y, -reach));
            bottom = std::max(bottom, std::min(at->y, reach));
        }
    return {origin.x + static_cast<std::int64_t>(std::floor(left)),
            origin.y + static_cast<std::int64_t>(std::floor(top)),
            origin.x + static_cast<std::int64_t>(std::ceil(right)) + 1,
            origin.y + static_cast<std::int64_t>(std::ceil(bottom)) + 1};
}

}  // namespace tessera
