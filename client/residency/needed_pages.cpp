#include "client/residency/needed_pages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "client/residency/footprint_pages.h"

namespace tessera {
namespace {

/// A convex polygon on the plane. A square clipped by six half-planes has at most ten corners.
struct Polygon {
    std::array<GroundPoint, 12> corners;
    std::size_t count = 0;
    void add(GroundPoint p) {
        if (count < corners.size()) corners[count++] = p;
    }
};

/// Keeps where a·x + b·y + c ≥ 0.
struct HalfPlane {
    double a, b, c;
    double side(GroundPoint p) const { return a * p.x + b * p.y + c; }
};

Polygon clip(const Polygon& polygon, const HalfPlane& plane) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const GroundPoint p = polygon.corners[i], q = polygon.corners[(i + 1) % polygon.count];
        const double side_p = plane.side(p), side_q = plane.side(q);
        if (side_p >= 0) kept.add(p);
        if ((side_p >= 0) != (side_q >= 0)) {
            const double t = side_p / (side_p - side_q);
            kept.add({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
        }
    }
    return kept;
}

/// The pages of the two levels around each pixel's level. Walks the quadtree from the coarsest page and clips
/// each page's square to the view. Everything is relative to the eye, so doubles are exact enough
/// at any place of any extent.
class Walk {
  public:
    Walk(const PlaneView& view, Extent extent, double lod_bias)
        : view_{view}, extent_{extent}, lod_bias_{lod_bias} {
        const Vector3 &f = view.forward(), &r = view.right(), &u = view.up();
        const double height = view.camera().height_texels;
        // Depth along the view of the ground point (x, y), and the frustum's four sides, all linear in x and
        // y
        depth_ = {f.x, f.y, -height * f.z};
        const auto side = [&](const Vector3& axis, double sign, double tangent) {
            return HalfPlane{tangent * f.x + sign * axis.x, tangent * f.y + sign * axis.y,
                             -height * (tangent * f.z + sign * axis.z)};
        };
        // The outermost rays go through the middles of the outermost pixels
        const double tangent_x = view.tangent_x() * (1 - 1.0 / view.width());
        const double tangent_y = view.tangent_y() * (1 - 1.0 / view.height());
        frustum_ = {side(r, 1, tangent_x), side(r, -1, tangent_x), side(u, 1, tangent_y),
                    side(u, -1, tangent_y)};
    }

    std::vector<NeededPage> run() {
        std::vector<PageKey> level{{extent_.n, 0, 0}}, finer;
        while (!level.empty()) {
            finer.clear();
            for (const PageKey key : level) visit(key, finer);
            std::swap(level, finer);
        }
        return std::move(found_);
    }

  private:
    void visit(PageKey key, std::vector<PageKey>& finer) {
        Polygon polygon = square_of(key);
        for (const HalfPlane& plane : frustum_) {
            polygon = clip(polygon, plane);
            if (polygon.count == 0) return;
        }
        const double stretch_low = stretch(least_across(polygon)),
                     stretch_high = stretch(most_across(polygon));

        // Finer pages are needed where some pixel's level is below this one
        if (key.level > 0 && reaches_below(polygon, key.level, stretch_low)) {
            for (std::uint32_t child = 0; child < 4; ++child)
                finer.push_back(
                    {static_cast<std::uint8_t>(key.level - 1), 2 * key.x + child % 2, 2 * key.y + child / 2});
        }
        // The page itself is needed where level − 1 < λ < level + 1
        if (key.level > 0) polygon = clip(polygon, farther_than(fall_at(key.level - 1, stretch_high)));
        if (polygon.count > 0 && key.level < extent_.n)
            polygon = clip(polygon, nearer_than(fall_at(key.level + 1, stretch_low)));
        if (polygon.count > 0) found_.push_back({key, pixels_of(polygon)});
    }

    Polygon square_of(PageKey key) const {
        const PlanePoint& eye = view_.camera().ground;
        const std::int64_t side = std::int64_t{page_side_texels} << key.level;
        const double left = static_cast<double>(key.x * side - eye.x) - eye.fraction_x;
        const double top = static_cast<double>(key.y * side - eye.y) - eye.fraction_y;
        const double right = left + static_cast<double>(side), bottom = top + static_cast<double>(side);
        Polygon square;
        square.add({left, top});
        square.add({right, top});
        square.add({right, bottom});
        square.add({left, bottom});
        return square;
    }

    /// The factor √(1 + (across · cos pitch)²) of PlaneView::level_at.
    double stretch(double across) const {
        const double slope = across * view_.up().z;
        return std::sqrt(1 + slope * slope);
    }
    double across(GroundPoint p) const {
        return (p.x * view_.right().x + p.y * view_.right().y) / depth_.side(p);
    }
    double most_across(const Polygon& polygon) const {
        double most = 0;
        for (std::size_t i = 0; i < polygon.count; ++i)
            most = std::max(most, std::abs(across(polygon.corners[i])));
        return std::min(most, view_.tangent_x());
    }
    double least_across(const Polygon& polygon) const {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::size_t i = 0; i < polygon.count; ++i) {
            low = std::min(low, across(polygon.corners[i]));
            high = std::max(high, across(polygon.corners[i]));
        }
        return low > 0 ? low : high < 0 ? -high : 0;
    }

    /// How much a ray of this level (+ bias) falls for each unit of depth: PlaneView::level_at, inverted.
    double fall_at(int level, double stretch_factor) const {
        const double scale = view_.camera().height_texels * view_.pixel_step() * std::exp2(lod_bias_ - level);
        return std::max(scale, std::sqrt(stretch_factor * scale));
    }
    /// A ground point at depth D is seen by a ray that falls by height / D.
    HalfPlane nearer_than(double fall) const {
        return {-depth_.a, -depth_.b, view_.camera().height_texels / fall - depth_.c};
    }
    HalfPlane farther_than(double fall) const {
        return {depth_.a, depth_.b, depth_.c - view_.camera().height_texels / fall};
    }
    bool reaches_below(const Polygon& polygon, int level, double stretch_factor) const {
        const HalfPlane near = nearer_than(fall_at(level, stretch_factor));
        for (std::size_t i = 0; i < polygon.count; ++i)
            if (near.side(polygon.corners[i]) > 0) return true;
        return false;
    }

    double pixels_of(const Polygon& polygon) const {
        const double height = view_.camera().height_texels, step = view_.pixel_step();
        const auto on_picture = [&](GroundPoint p) {
            const double depth = depth_.side(p);
            const double up = p.x * view_.up().x + p.y * view_.up().y - height * view_.up().z;
            return GroundPoint{across(p) / step, up / depth / step};
        };
        double doubled = 0;
        GroundPoint last = on_picture(polygon.corners[polygon.count - 1]);
        for (std::size_t i = 0; i < polygon.count; ++i) {
            const GroundPoint next = on_picture(polygon.corners[i]);
            doubled += last.x * next.y - next.x * last.y;
            last = next;
        }
        return std::abs(doubled) / 2;
    }

    const PlaneView& view_;
    Extent extent_;
    double lod_bias_;
    HalfPlane depth_{};
    std::array<HalfPlane, 4> frustum_{};
    std::vector<NeededPage> found_;
};

}  // namespace

std::vector<NeededPage> needed_pages(const PlaneView& view, Extent extent, double lod_bias,
                                     const Sampling& sampling) {
    if (sampling.kind != Sampling::Kind::isotropic)
        return needed_by_footprints(view, extent, lod_bias, sampling);
    return Walk{view, extent, lod_bias - std::log2(sampling.subdivisions)}.run();
}

}  // namespace tessera
