#include "client/residency/needed_pages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "client/residency/footprint_pages.h"
#include "client/residency/pixel_reads.h"

namespace tessera {
namespace {

constexpr double float_margin = 0.003;  ///< Of levels, in the shader.

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

/// The pages of the levels less than `reach` from each pixel's level: 1 for the two around it, ½ for the
/// nearer one. Walks the quadtree from the coarsest page and clips
/// each page's square to the view. Everything is relative to the eye, so doubles are exact enough
/// at any place of any extent.
class Walk {
  public:
    Walk(const PlaneView& view, Extent extent, double lod_bias, const Sampling& sampling)
        : view_{view},
          extent_{extent},
          lod_bias_{lod_bias},
          reach_{(sampling.kind == Sampling::Kind::nearest_level ? 0.5 : 1) + float_margin},
          reads_{view, extent, lod_bias, sampling} {
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
        const auto across = [&](int column) {
            return view.tangent_x() * ((2.0 * column + 1) / view.width() - 1);
        };
        const double tangent_y = view.tangent_y() * (1 - 1.0 / view.height());
        frustum_ = {side(r, 1, -across(view.first_column())), side(r, -1, across(view.end_column() - 1)),
                    side(u, 1, tangent_y), side(u, -1, tangent_y)};
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
        // The page itself is needed where level − reach < λ < level + reach
        if (!meets_level(polygon, key.level)) return;
        polygon = at_level(polygon, key.level, stretch_low, stretch_high);
        if (polygon.count == 0) return;
        const Seen seen = seen_of(polygon);
        if (is_read(key, seen)) found_.push_back({key, seen.pixels});
    }

    /// A polygon's part whose level is near enough to this one, for stretches between these.
    Polygon at_level(Polygon polygon, int level, double stretch_low, double stretch_high) const {
        if (level > 0) polygon = clip(polygon, farther_than(fall_at(level - reach_, stretch_high)));
        if (polygon.count > 0 && level < extent_.n)
            polygon = clip(polygon, nearer_than(fall_at(level + reach_, stretch_low)));
        return polygon;
    }

    /// Whether some of a polygon's points are of levels near enough to this one. Points of one distance are
    /// of several levels, by how far aside they lie: where that decides, the polygon is cut in two.
    bool meets_level(const Polygon& polygon, int level, int cuts = 6) const {
        if (polygon.count == 0) return false;
        const double low = stretch(least_across(polygon)), high = stretch(most_across(polygon));
        if (at_level(polygon, level, low, high).count == 0) return false;
        if (cuts == 0 || high < 1.002 * low || at_level(polygon, level, high, low).count > 0) return true;
        double left = across(polygon.corners[0]), right = left;
        for (std::size_t i = 1; i < polygon.count; ++i) {
            left = std::min(left, across(polygon.corners[i]));
            right = std::max(right, across(polygon.corners[i]));
        }
        const double middle = left < 0 && right > 0 ? 0 : (left + right) / 2;
        const Vector3& aside = view_.right();
        const HalfPlane beyond{aside.x - middle * depth_.a, aside.y - middle * depth_.b, -middle * depth_.c};
        const HalfPlane before{-beyond.a, -beyond.b, -beyond.c};
        return meets_level(clip(polygon, beyond), level, cuts - 1) ||
               meets_level(clip(polygon, before), level, cuts - 1);
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
    double fall_at(double level, double stretch_factor) const {
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
        const HalfPlane near = nearer_than(fall_at(level - 1 + reach_, stretch_factor));
        for (std::size_t i = 0; i < polygon.count; ++i)
            if (near.side(polygon.corners[i]) > 0) return true;
        return false;
    }

    /// Of the picture: how many pixels a polygon covers, and between which it lies.
    struct Seen {
        double pixels = 0;
        double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
    };
    Seen seen_of(const Polygon& polygon) const {
        const double height = view_.camera().height_texels, step = view_.pixel_step();
        Seen seen;
        const auto on_picture = [&](GroundPoint p) {
            const double up = p.x * view_.up().x + p.y * view_.up().y - height * view_.up().z;
            const GroundPoint at{across(p) / step + view_.width() / 2.0,
                                 view_.height() / 2.0 - up / depth_.side(p) / step};
            seen.left = std::min(seen.left, at.x);
            seen.right = std::max(seen.right, at.x);
            seen.top = std::min(seen.top, at.y);
            seen.bottom = std::max(seen.bottom, at.y);
            return at;
        };
        double doubled = 0;
        GroundPoint last = on_picture(polygon.corners[polygon.count - 1]);
        for (std::size_t i = 0; i < polygon.count; ++i) {
            const GroundPoint next = on_picture(polygon.corners[i]);
            doubled += last.x * next.y - next.x * last.y;
            last = next;
        }
        seen.pixels = std::abs(doubled) / 2;
        return seen;
    }

    /// The polygon is a bit too large, since a page's pixels are of more than one level: where it has few
    /// pixels, these are looked at one by one.
    bool is_read(PageKey key, const Seen& seen) {
        constexpr double few = 300;
        if (!(seen.pixels < few) || (seen.right - seen.left + 2) * (seen.bottom - seen.top + 2) > 3 * few)
            return true;
        const auto first = [](double at, int size) {
            return std::clamp(static_cast<int>(std::floor(at)) - 1, 0, size);
        };
        const auto end = [](double at, int size) {
            return std::clamp(static_cast<int>(std::ceil(at)) + 1, 0, size);
        };
        for (int y = first(seen.top, view_.height()); y < end(seen.bottom, view_.height()); ++y) {
            for (int x = std::max(first(seen.left, view_.width()), view_.first_column());
                 x < std::min(end(seen.right, view_.width()), view_.end_column()); ++x) {
                if (!reads_.sees_plane(x, y)) continue;
                read_.clear();
                reads_.add_pages(x, y, read_);
                if (std::ranges::find(read_, key) != read_.end()) return true;
            }
        }
        return false;
    }

    const PlaneView& view_;
    Extent extent_;
    double lod_bias_;
    double reach_;
    PixelReads reads_;
    std::vector<PageKey> read_;
    HalfPlane depth_{};
    std::array<HalfPlane, 4> frustum_{};
    std::vector<NeededPage> found_;
};

}  // namespace

std::vector<NeededPage> needed_pages(const PlaneView& view, Extent extent, double lod_bias,
                                     const Sampling& sampling) {
    if (const auto& split = view.split()) {
        std::vector<NeededPage> pages = needed_pages(view.part(0, split->column), extent, lod_bias, sampling);
        for (const NeededPage& page :
             needed_pages(view.part(split->column, view.width()), extent, lod_bias, split->right)) {
            const auto known = std::ranges::find(pages, page.key, &NeededPage::key);
            if (known == pages.end())
                pages.push_back(page);
            else
                known->pixels += page.pixels;
        }
        std::ranges::stable_sort(pages, std::ranges::greater{},
                                 [](const NeededPage& page) { return page.key.level; });
        return pages;
    }
    if (view.pieces().empty()) return {};
    if (view.is_plane() &&
        (sampling.kind == Sampling::Kind::isotropic || sampling.kind == Sampling::Kind::nearest_level))
        return Walk{view, extent, lod_bias, sampling}.run();
    return needed_by_footprints(view, extent, lod_bias, sampling);
}

}  // namespace tessera
