#include "client/view/picture_pieces.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tessera {
namespace {

using Box = BoxTree::Box;

constexpr Box nowhere{INFINITY, INFINITY, -INFINITY, -INFINITY};
constexpr Box everywhere{-INFINITY, -INFINITY, INFINITY, INFINITY};

void take_in(Box& box, const Box& other) {
    box = {std::min(box.left, other.left), std::min(box.top, other.top), std::max(box.right, other.right),
           std::max(box.bottom, other.bottom)};
}

double along(const std::array<double, 3>& row, const Vector3& place) {
    return row[0] * place.x + row[1] * place.y + row[2] * place.z;
}

/// Around a piece in the texture.
Box texels_of(const FlatPiece& piece, const PlaneView& view) {
    Box box = nowhere;
    for (std::size_t i = 0; i < static_cast<std::size_t>(piece.corner_count); ++i) {
        const GroundPoint at = texel_at(piece, view, piece.corners[i]);
        take_in(box, {at.x, at.y, at.x, at.y});
    }
    const double slack =
        1e-9 * (std::abs(box.left) + std::abs(box.right) + std::abs(box.top) + std::abs(box.bottom));
    return {box.left - slack, box.top - slack, box.right + slack, box.bottom + slack};
}

/// Around a piece in the picture, in pixels from its middle; where it reaches behind the eye: everywhere.
Box pixels_of(const FlatPiece& piece, const PlaneView& view) {
    Box box = nowhere;
    for (std::size_t i = 0; i < static_cast<std::size_t>(piece.corner_count); ++i) {
        const Vector3& corner = piece.corners[i];
        const double depth = dot(corner, view.forward());
        if (!(depth > 1e-6 * view.camera().height_texels)) return everywhere;
        const double x = dot(corner, view.right()) / depth / view.pixel_step(),
                     y = -dot(corner, view.up()) / depth / view.pixel_step();
        take_in(box, {x, y, x, y});
    }
    constexpr double slack = 1e-3;
    return {box.left - slack, box.top - slack, box.right + slack, box.bottom + slack};
}

/// Whether the ray through a place of the picture, counted from its middle, meets the piece. What passes
/// along an edge does, whatever the rounding: pieces leave no cracks.
bool holds(const FlatPiece& piece, const PlaneView& view, double x, double y) {
    const double step = view.pixel_step();
    const auto of = [&](double forward, double right, double up) {
        return forward + x * step * right - y * step * up;
    };
    const Vector3 ray{of(view.forward().x, view.right().x, view.up().x),
                      of(view.forward().y, view.right().y, view.up().y),
                      of(view.forward().z, view.right().z, view.up().z)};
    int left = 0, right = 0;
    for (int i = 0; i < piece.corner_count; ++i) {
        const Vector3& a = piece.corners[static_cast<std::size_t>(i)];
        const Vector3& b = piece.corners[static_cast<std::size_t>((i + 1) % piece.corner_count)];
        const double side = dot(ray, cross(a, b)),
                     slack = 1e-12 * std::sqrt(dot(ray, ray) * dot(a, a) * dot(b, b));
        if (side > slack) ++left;
        if (side < -slack) ++right;
    }
    return left == 0 || right == 0;
}

/// Which side of a corridor it is part of: by where it faces.
int side_of(const FlatPiece& piece) {
    const Vector3 n = cross(piece.corners[1] - piece.corners[0], piece.corners[2] - piece.corners[0]);
    if (std::abs(n.z) > std::abs(n.x)) return piece.corners[0].z < 0 ? 0 : 2;
    return piece.corners[0].x > 0 ? 1 : 3;
}

}  // namespace

BoxTree::BoxTree(std::vector<Box> boxes) : boxes_{std::move(boxes)}, order_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::size_t nodes = 2;
    for (std::size_t size = order_.size(); size > most_in_leaf; size = (size + 1) / 2) nodes *= 2;
    around_.assign(nodes, nowhere);
    build(1, 0, order_.size());
}

void BoxTree::build(std::size_t node, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) take_in(around_[node], boxes_[order_[i]]);
    if (end - first <= most_in_leaf) return;
    const Box& around = around_[node];
    const bool is_wide = around.right - around.left > around.bottom - around.top;
    const auto place = [&](std::size_t i) {
        const Box& box = boxes_[i];
        return is_wide ? std::max(box.left, -1e300) + std::min(box.right, 1e300)
                       : std::max(box.top, -1e300) + std::min(box.bottom, 1e300);
    };
    const std::size_t middle = (first + end) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(first), at(middle), at(end),
                     [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
    build(2 * node, first, middle);
    build(2 * node + 1, middle, end);
}

Box texels_of(const PlaneView& view) {
    Box around = nowhere;
    for (const FlatPiece& piece : view.pieces()) take_in(around, texels_of(piece, view));
    return around;
}

PicturePieces::PicturePieces(const PlaneView& view) : view_{view} {
    std::vector<Box> texels, pixels;
    for (const FlatPiece& piece : view_.pieces()) {
        sheets_.push_back(sheets(view.surface()) == 1 ? 0 : side_of(piece));
        texels.push_back(texels_of(piece, view));
        pixels.push_back(pixels_of(piece, view));
    }
    by_texel_.emplace(std::move(texels));
    by_pixel_.emplace(std::move(pixels));
}

std::optional<PicturePieces::Pixel> PicturePieces::pixel_of(double x, double y, int sheet) const {
    std::optional<Pixel> found;
    double found_w = 0;
    by_texel_->each_at(x, y, [&](std::size_t index) {
        const FlatPiece& piece = view_.pieces()[index];
        if (sheets_[index] != sheet) return;
        // (s·p) = x (w·p) and (t·p) = y (w·p)
        const auto row = [&](const std::array<double, 3>& from, double times) {
            return Vector3{from[0] - times * piece.w[0], from[1] - times * piece.w[1],
                           from[2] - times * piece.w[2]};
        };
        const Vector3 line = cross(row(piece.s, x), row(piece.t, y));
        if (line.z == 0) return;
        const Vector3 place{line.x / line.z, line.y / line.z, 1};
        const double w = along(piece.w, place);
        if (!(w > found_w) || !holds(piece, view_, place.x, place.y)) return;
        found = Pixel{place.x, place.y};
        found_w = w;
    });
    if (!found || is_hidden(*found, found_w)) return std::nullopt;
    return Pixel{found->x + view_.width() / 2.0, found->y + view_.height() / 2.0};
}

bool PicturePieces::is_hidden(const Pixel& pixel, double w) const {
    constexpr double same = 1 + 1e-9;  // pieces that meet here
    bool hidden = false;
    by_pixel_->each_at(pixel.x, pixel.y, [&](std::size_t index) {
        const FlatPiece& piece = view_.pieces()[index];
        if (!hidden && along(piece.w, {pixel.x, pixel.y, 1}) > same * w &&
            holds(piece, view_, pixel.x, pixel.y))
            hidden = true;
    });
    return hidden;
}

}  // namespace tessera
