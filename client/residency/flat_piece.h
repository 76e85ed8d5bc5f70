#pragma once

#include <array>
#include <vector>

#include "client/residency/camera.h"
#include "client/residency/surface.h"

namespace tessera {

class PlaneView;

/// x east, y south, z up, in texels of level 0.
struct Vector3 {
    double x = 0;
    double y = 0;
    double z = 0;
};
inline double dot(const Vector3& a, const Vector3& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector3 operator-(const Vector3& a, const Vector3& b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vector3 cross(const Vector3& a, const Vector3& b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A flat piece of a surface as a camera sees it. A pixel's place p = (px, py, 1), counted from the middle of
/// the picture, y down, sees the texel (s·p, t·p) / (w·p), counted from the clip centre. w·p is the
/// reciprocal of the depth, above 0 where the piece's plane is before the eye: of two pieces the one with the
/// greater w is seen. The same three rows make the picture (shaders/surface.frag) and say which pages it
/// reads.
struct FlatPiece {
    std::array<double, 3> s{}, t{}, w{};
    std::array<Vector3, 4> corners{};  ///< From the eye; a convex polygon, its corners in order.
    int corner_count = 0;              ///< 3 or 4; 0: the whole plane, up to its horizon.
    /// How much of the light falls on the first three corners, 0 to about 1, and evenly between.
    std::array<double, 3> light{1, 1, 1};
};

/// How the texture lies on a piece's plane: texel (x, y) = across·X + at, X counted from the eye, and the
/// texel from the clip centre.
struct PieceTexture {
    Vector3 across_x{1, 0, 0}, across_y{0, 1, 0};
    double at_x = 0, at_y = 0;
};

/// The pieces that may be in the picture: all that face the eye, and are not wholly beside the picture.
std::vector<FlatPiece> pieces_of(const Surface& surface, const PlaneView& view);

/// The rows s, t, w of a plane normal·X = distance, X counted from the eye. False if it is seen edge on.
bool set_rows(FlatPiece& piece, const PlaneView& view, const Vector3& normal, double distance,
              const PieceTexture& texture);

/// Adds the polygon of these corners (3 or 4), unless it faces away or lies beside the picture.
void add_piece(std::vector<FlatPiece>& pieces, const PlaneView& view, const std::array<Vector3, 4>& corners,
               int corner_count, const PieceTexture& texture, const std::array<double, 3>& light = {1, 1, 1});

}  // namespace tessera
