#include "client/residency/terrain_mesh.h"

#include <algorithm>
#include <cmath>

#include "client/residency/height_field.h"
#include "client/residency/plane_view.h"

namespace tessera {
namespace {

constexpr int finest_log2 = 8;      ///< Texels from one vertex to the next
constexpr std::int64_t reach = 12;  ///< Cells of a ring from its middle to its outer edge
constexpr double farthest = 400;    ///< Of the last ring: eye heights; beyond it all is haze
constexpr double least_scale =
    2000;  ///< Texels: hills are seen this high at least, whatever the eye's height
constexpr int most_rings = 34;

constexpr Vector3 sun{-0.55, -0.45, 0.704};  ///< Towards it: the north-west, as maps have it
constexpr double ambient = 0.25;
constexpr double sun_on_flat = ambient + (1 - ambient) * sun.z;

double height_of(const Surface& surface, std::int64_t x, std::int64_t y, std::int64_t spacing) {
    const double height = surface.heights ? surface.heights->at(x, y) / 257
                                          : static_cast<double>(made_height(x, y, spacing)) / 64;
    return surface.relief * height;
}

class Mesh {
  public:
    Mesh(const Surface& surface, const PlaneView& view)
        : surface_{surface}, view_{view}, eye_{view.camera().ground} {
        const double height = view.camera().height_texels;
        const int coarser = std::clamp(static_cast<int>(std::floor(std::log2(height / 4))), finest_log2, 40);
        const double scale = farthest * std::max(height, least_scale);
        for (int ring = 0; ring < most_rings; ++ring) {
            const std::int64_t spacing = std::int64_t{1} << (coarser + ring);
            const bool is_last = static_cast<double>(spacing * reach) > scale;
            add_ring(spacing, ring == 0, is_last);
            if (is_last) break;
        }
    }
    std::vector<FlatPiece> take() { return std::move(pieces_); }

  private:
    /// Of the lattice with this spacing: the even point nearest to the eye.
    static std::int64_t middle_of(std::int64_t eye, std::int64_t spacing) {
        const std::int64_t twice = 2 * spacing;
        return (eye + spacing) / twice * twice;
    }

    void add_ring(std::int64_t spacing, bool is_first, bool is_last) {
        spacing_ = spacing;
        is_last_ = is_last;
        middle_x_ = middle_of(eye_.x, spacing);
        middle_y_ = middle_of(eye_.y, spacing);
        is_first_ = is_first;
        inner_x_ = (middle_of(eye_.x, spacing / 2) - middle_x_) / spacing;
        inner_y_ = (middle_of(eye_.y, spacing / 2) - middle_y_) / spacing;
        std::ranges::fill(known_, false);
        for (std::int64_t row = -reach; row < reach; ++row)
            for (std::int64_t column = -reach; column < reach; ++column)
                if (!is_inside(column, row) && may_be_seen(column, row)) add_cell(column, row);
        if (is_last) add_skirt();
    }

    /// Of a cell: the ring inside this one covers it.
    bool is_inside(std::int64_t column, std::int64_t row) const {
        return !is_first_ && column >= inner_x_ - reach / 2 && column < inner_x_ + reach / 2 &&
               row >= inner_y_ - reach / 2 && row < inner_y_ + reach / 2;
    }

    /// By its place on the plane alone: heights of cells beside the picture are not worth knowing.
    bool may_be_seen(std::int64_t column, std::int64_t row) const {
        const Camera& camera = view_.camera();
        if (camera.pitch_degrees < -50) return true;
        const auto cell = static_cast<double>(spacing_);
        const double x = distance(middle_x_ + column * spacing_, eye_.x, eye_.fraction_x) + cell / 2,
                     y = distance(middle_y_ + row * spacing_, eye_.y, eye_.fraction_y) + cell / 2;
        const double ahead = x * view_.right().y - y * view_.right().x;
        return ahead > -2 * cell;
    }

    static double distance(std::int64_t at, std::int64_t eye, double fraction) {
        return static_cast<double>(at - eye) - fraction;
    }

    /// A vertex of the ring, from the eye.
    Vector3 vertex(std::int64_t column, std::int64_t row) {
        double height = height_at(column, row);
        // The outer edge is the next ring's inner one, which knows every second vertex
        const bool on_column = column == -reach || column == reach, on_row = row == -reach || row == reach;
        if (!is_last_ && on_column && (row & 1) != 0)
            height = (height_at(column, row - 1) + height_at(column, row + 1)) / 2;
        else if (!is_last_ && on_row && (column & 1) != 0)
            height = (height_at(column - 1, row) + height_at(column + 1, row)) / 2;
        return {distance(middle_x_ + column * spacing_, eye_.x, eye_.fraction_x),
                distance(middle_y_ + row * spacing_, eye_.y, eye_.fraction_y), height - view_.eye_height()};
    }

    double height_at(std::int64_t column, std::int64_t row) {
        const auto at = static_cast<std::size_t>((row + reach) * (2 * reach + 1) + column + reach);
        if (!known_[at]) {
            const bool on_edge = std::abs(column) == reach || std::abs(row) == reach;
            heights_[at] = height_of(surface_, middle_x_ + column * spacing_, middle_y_ + row * spacing_,
                                     on_edge && !is_last_ ? 2 * spacing_ : spacing_);
            known_[at] = true;
        }
        return heights_[at];
    }

    void add_cell(std::int64_t column, std::int64_t row) {
        const Vector3 a = vertex(column, row), b = vertex(column + 1, row), c = vertex(column + 1, row + 1),
                      d = vertex(column, row + 1);
        const double light_a = light_at(column, row), light_c = light_at(column + 1, row + 1);
        const double light_b = light_at(column + 1, row), light_d = light_at(column, row + 1);
        half_cell({a, b, c}, {light_a, light_b, light_c}, is_inside(column, row - 1),
                  is_inside(column + 1, row));
        half_cell({c, d, a}, {light_c, light_d, light_a}, is_inside(column, row + 1),
                  is_inside(column - 1, row));
    }

    /// A triangle whose first two sides may border on the ring inside: that has a vertex in their middles,
    /// and so has this, or there would be cracks.
    void half_cell(const std::array<Vector3, 3>& at, const std::array<double, 3>& light, bool splits_first,
                   bool splits_second) {
        const auto middle = [](const Vector3& p, const Vector3& q) {
            return Vector3{(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2};
        };
        const double light_first = (light[0] + light[1]) / 2, light_second = (light[1] + light[2]) / 2;
        const Vector3 first = middle(at[0], at[1]), second = middle(at[1], at[2]);
        if (splits_first && splits_second) {
            triangle(at[0], first, at[2], {light[0], light_first, light[2]});
            triangle(first, second, at[2], {light_first, light_second, light[2]});
            triangle(first, at[1], second, {light_first, light[1], light_second});
        } else if (splits_first) {
            triangle(at[0], first, at[2], {light[0], light_first, light[2]});
            triangle(first, at[1], at[2], {light_first, light[1], light[2]});
        } else if (splits_second) {
            triangle(at[0], at[1], second, {light[0], light[1], light_second});
            triangle(at[0], second, at[2], {light[0], light_second, light[2]});
        } else {
            triangle(at[0], at[1], at[2], light);
        }
    }

    /// From the outermost edge to beyond all that is seen.
    void add_skirt() {
        const auto away = [&](const Vector3& v) { return Vector3{v.x * 30, v.y * 30, -view_.eye_height()}; };
        const auto side = [&](const Vector3& a, const Vector3& b) {
            triangle(a, b, away(b));
            triangle(a, away(b), away(a));
        };
        for (std::int64_t i = -reach; i < reach; ++i) {
            side(vertex(i + 1, -reach), vertex(i, -reach));
            side(vertex(i, reach), vertex(i + 1, reach));
            side(vertex(-reach, i), vertex(-reach, i + 1));
            side(vertex(reach, i + 1), vertex(reach, i));
        }
    }

    void triangle(const Vector3& a, const Vector3& b, const Vector3& c,
                  const std::array<double, 3>& light = {sun_on_flat, sun_on_flat, sun_on_flat}) {
        add_piece(pieces_, view_, {a, b, c, c}, 3, {}, light);
    }

    /// By the slope at a vertex.
    double light_at(std::int64_t column, std::int64_t row) {
        const auto clamped = [](std::int64_t at) { return std::clamp(at, -reach, reach); };
        const auto slope = [&](std::int64_t dx, std::int64_t dy) {
            const std::int64_t left = clamped(column - dx), right = clamped(column + dx),
                               top = clamped(row - dy), bottom = clamped(row + dy);
            return (height_at(right, bottom) - height_at(left, top)) /
                   static_cast<double>((right - left + bottom - top) * spacing_);
        };
        const double x = slope(1, 0), y = slope(0, 1);
        const double facing = (-x * sun.x - y * sun.y + sun.z) / std::sqrt(x * x + y * y + 1);
        return ambient + (1 - ambient) * std::max(facing, 0.0);
    }

    const Surface& surface_;
    const PlaneView& view_;
    const PlanePoint& eye_;
    std::int64_t spacing_ = 0, middle_x_ = 0, middle_y_ = 0;
    std::int64_t inner_x_ = 0, inner_y_ = 0;  ///< Middle of the ring inside, in cells
    bool is_first_ = false, is_last_ = false;
    static constexpr std::size_t vertices = (2 * reach + 1) * (2 * reach + 1);
    std::array<double, vertices> heights_{};
    std::array<bool, vertices> known_{};
    std::vector<FlatPiece> pieces_;
};

}  // namespace

std::vector<FlatPiece> terrain_pieces(const Surface& surface, const PlaneView& view) {
    return Mesh{surface, view}.take();
}

double terrain_base(const Surface& surface, const PlanePoint& ground) {
    constexpr std::int64_t spacing = std::int64_t{1} << finest_log2;
    const std::int64_t left = ground.x >> finest_log2 << finest_log2,
                       top = ground.y >> finest_log2 << finest_log2;
    const auto at = [&](std::int64_t dx, std::int64_t dy) {
        return height_of(surface, left + dx * spacing, top + dy * spacing, spacing);
    };
    const double u = (static_cast<double>(ground.x - left) + ground.fraction_x) / spacing,
                 v = (static_cast<double>(ground.y - top) + ground.fraction_y) / spacing;
    // The cell's diagonal runs from its top left corner
    const double corner = at(0, 0), across = at(1, 1);
    if (u > v) {
        const double right = at(1, 0);
        return corner + u * (right - corner) + v * (across - right);
    }
    const double below = at(0, 1);
    return corner + v * (below - corner) + u * (across - below);
}

}  // namespace tessera
