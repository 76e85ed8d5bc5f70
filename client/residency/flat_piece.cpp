#include "client/residency/flat_piece.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "client/residency/height_field.h"
#include "client/residency/plane_view.h"
#include "client/residency/terrain_mesh.h"

namespace tessera {
namespace {

/// Four sides that reach as far as anything is seen; the texture is folded where they meet, so that it goes
/// on over every edge.
std::vector<FlatPiece> corridor(const Surface& surface, const PlaneView& view) {
    const Camera& camera = view.camera();
    const double half = surface.half_side;
    const double middle = static_cast<double>(surface.middle_x - camera.ground.x) - camera.ground.fraction_x;
    const double west = middle - half, east = middle + half, floor = -camera.height_texels,
                 ceiling = floor + 2 * half;
    // In parts, the farther the longer: corners far away would be too coarse for a GPU's floats nearby
    constexpr double cuts[] = {-4000, -400, -40, -4, 4, 40, 400, 4000};
    std::vector<FlatPiece> pieces;
    const auto add = [&](double x0, double z0, double x1, double z1, double light,
                         const PieceTexture& texture) {
        for (std::size_t i = 0; i + 1 < std::size(cuts); ++i) {
            const double north = half * cuts[i], south = half * cuts[i + 1];
            add_piece(pieces, view,
                      {Vector3{x0, north, z0}, Vector3{x1, north, z1}, Vector3{x1, south, z1},
                       Vector3{x0, south, z0}},
                      4, texture, {light, light, light});
        }
    };
    add(west, floor, east, floor, 1, {});
    add(east, floor, east, ceiling, 0.82, {{0, 0, -1}, {0, 1, 0}, east + floor, 0});
    add(east, ceiling, west, ceiling, 0.5, {{-1, 0, 0}, {0, 1, 0}, 2 * middle, 0});
    add(west, ceiling, west, floor, 0.68, {{0, 0, 1}, {0, 1, 0}, west - floor, 0});
    return pieces;
}

/// Thinner in the picture than a tenth of a pixel: seen so nearly edge on that no pixel could tell what it
/// shows.
bool is_sliver(const PlaneView& view, const std::array<Vector3, 4>& corners, std::size_t count) {
    constexpr double thinnest = 0.1;
    std::array<Vector3, 4> at{};  // in pixels
    for (std::size_t i = 0; i < count; ++i) {
        const double depth = dot(corners[i], view.forward());
        if (!(depth > 1e-4 * view.camera().height_texels)) return false;
        const double scale = 1 / (depth * view.pixel_step());
        at[i] = {scale * dot(corners[i], view.right()), scale * dot(corners[i], view.up()), 0};
    }
    double doubled_area = 0, longest_squared = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Vector3 side = at[(i + 1) % count] - at[i];
        doubled_area += cross(at[i] - at[0], side).z;
        longest_squared = std::max(longest_squared, dot(side, side));
    }
    return std::abs(doubled_area) < thinnest * std::sqrt(longest_squared);
}

}  // namespace

bool set_rows(FlatPiece& piece, const PlaneView& view, const Vector3& normal, double distance,
              const PieceTexture& texture) {
    if (distance == 0) return false;
    // The ray through p: forward + px·step·right − py·step·up. It meets the plane at X = ray·distance /
    // (normal·ray)
    const double step = view.pixel_step();
    const auto row = [&](const Vector3& v, double scale) {
        return std::array{scale * step * dot(v, view.right()), -scale * step * dot(v, view.up()),
                          scale * dot(v, view.forward())};
    };
    piece.w = row(normal, 1 / distance);
    piece.s = row(texture.across_x, 1);
    piece.t = row(texture.across_y, 1);
    for (std::size_t i = 0; i < 3; ++i) {
        piece.s[i] += texture.at_x * piece.w[i];
        piece.t[i] += texture.at_y * piece.w[i];
    }
    return true;
}

void add_piece(std::vector<FlatPiece>& pieces, const PlaneView& view, const std::array<Vector3, 4>& corners,
               int corner_count, const PieceTexture& texture, const std::array<double, 3>& light) {
    const auto count = static_cast<std::size_t>(corner_count);
    // Wholly beside the picture, or behind the eye
    const auto outside = [&](const Vector3& axis, double tangent) {
        for (std::size_t i = 0; i < count; ++i)
            if (dot(corners[i], axis) <= tangent * dot(corners[i], view.forward())) return false;
        return true;
    };
    const auto minus = [](const Vector3& v) { return Vector3{-v.x, -v.y, -v.z}; };
    if (outside(view.right(), view.tangent_x()) || outside(minus(view.right()), view.tangent_x()) ||
        outside(view.up(), view.tangent_y()) || outside(minus(view.up()), view.tangent_y()))
        return;
    const Vector3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    // Counted the way that faces the eye; a piece that does not is behind one that does
    const double distance = dot(normal, corners[0]);
    const double size = std::sqrt(dot(normal, normal) * dot(corners[0], corners[0]));
    if (!(distance < -1e-12 * size)) return;
    if (is_sliver(view, corners, count)) return;
    FlatPiece piece;
    if (!set_rows(piece, view, normal, distance, texture)) return;
    piece.corners = corners;
    piece.corner_count = corner_count;
    piece.light = light;
    pieces.push_back(piece);
}

std::vector<FlatPiece> pieces_of(const Surface& surface, const PlaneView& view) {
    switch (surface.kind) {
        case Surface::Kind::terrain:
            return terrain_pieces(surface, view);
        case Surface::Kind::corridor:
            return corridor(surface, view);
        case Surface::Kind::plane:
            break;
    }
    FlatPiece whole;
    set_rows(whole, view, {0, 0, 1}, -view.camera().height_texels, {});
    return {whole};
}

Surface around(Surface surface, const Camera& camera) {
    if (surface.kind == Surface::Kind::corridor) {
        surface.middle_x = camera.ground.x;
        surface.half_side = camera.height_texels;
    }
    return surface;
}

double base_height(const Surface& surface, const PlanePoint& ground) {
    return surface.kind == Surface::Kind::terrain ? terrain_base(surface, ground) : 0;
}

}  // namespace tessera
