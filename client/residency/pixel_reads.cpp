#include "client/residency/pixel_reads.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

// How far the shader's floats may be off
constexpr double level_margin = 0.003;
constexpr double texel_margin = 0.04;
constexpr double ratio_margin = 1e-4;
/// More pages in a row than any window holds: what lies beyond it is shown by coarser pages.
constexpr std::int64_t most_pages = 256;
constexpr double gutter = 4;

GroundPoint operator+(GroundPoint a, GroundPoint b) { return {a.x + b.x, a.y + b.y}; }
GroundPoint operator-(GroundPoint a, GroundPoint b) { return {a.x - b.x, a.y - b.y}; }
GroundPoint operator*(double s, GroundPoint p) { return {s * p.x, s * p.y}; }
double length(GroundPoint p) { return std::sqrt(p.x * p.x + p.y * p.y); }

/// Whether a side of the quadrilateral separates it from the square; the square's own sides are known not to.
bool is_apart(const Quadrilateral& corners, double left, double top, double side) {
    for (std::size_t i = 0; i < 4; ++i) {
        const GroundPoint a = corners[i], b = corners[(i + 1) % 4], opposite = corners[(i + 2) % 4];
        const double nx = b.y - a.y, ny = a.x - b.x;
        const double sign = nx * (opposite.x - a.x) + ny * (opposite.y - a.y) < 0 ? -1 : 1;
        const double at = sign * (nx * (left - a.x) + ny * (top - a.y));
        if (at + std::max(0.0, sign * nx * side) + std::max(0.0, sign * ny * side) < 0) return true;
    }
    return false;
}

}  // namespace

PixelReads::PixelReads(const PlaneView& view, Extent extent, double lod_bias, const Sampling& sampling)
    : view_{view}, piece_{view.pieces().data()}, extent_{extent}, lod_bias_{lod_bias}, sampling_{sampling} {
    // Split, so that no double holds an absolute coordinate
    const PlanePoint& eye = view.camera().ground;
    for (int level = 0; level <= extent.n; ++level) {
        Origin& origin = origins_[static_cast<std::size_t>(level)];
        origin.page_x = eye.x >> (8 + level);
        origin.page_y = eye.y >> (8 + level);
        origin.within_x = static_cast<double>(eye.x - (origin.page_x << (8 + level))) + eye.fraction_x;
        origin.within_y = static_cast<double>(eye.y - (origin.page_y << (8 + level))) + eye.fraction_y;
    }
}

/// w·p of the piece: more than 0 before its horizon.
double PixelReads::nearness(double x, double y) const {
    return piece_->w[0] * (x - view_.width() / 2.0) + piece_->w[1] * (y - view_.height() / 2.0) +
           piece_->w[2];
}

/// Where a place of the picture lies, which near the horizon may be beyond it: as point_at of the shaders.
GroundPoint PixelReads::ground(double x, double y, double least_nearness) const {
    const double px = x - view_.width() / 2.0, py = y - view_.height() / 2.0;
    const double w = std::max(piece_->w[0] * px + piece_->w[1] * py + piece_->w[2], least_nearness);
    return {(piece_->s[0] * px + piece_->s[1] * py + piece_->s[2]) / w,
            (piece_->t[0] * px + piece_->t[1] * py + piece_->t[2]) / w};
}

PixelReads::Footprint PixelReads::footprint(double x, double y) const {
    const double w = nearness(x, y);
    Footprint made;
    made.middle = ground(x, y, 1e-300);
    const auto side = [&](std::size_t axis) {
        return (1 / w) * GroundPoint{piece_->s[axis] - made.middle.x * piece_->w[axis],
                                     piece_->t[axis] - made.middle.y * piece_->w[axis]};
    };
    made.dx = side(0);
    made.dy = side(1);
    const double dx = length(made.dx), dy = length(made.dy);
    made.longer = std::max(dx, dy);
    made.shorter = std::max(std::min(dx, dy), 1e-20);
    return made;
}

int PixelReads::clamped(double level) const {
    return static_cast<int>(std::clamp(level, 0.0, static_cast<double>(extent_.n)));
}

void PixelReads::add_page(GroundPoint at, int level, std::vector<PageKey>& pages) const {
    const Origin& origin = origins_[static_cast<std::size_t>(level)];
    const auto side = static_cast<double>(std::int64_t{page_side_texels} << level);
    const double margin = texel_margin / page_side_texels;
    const double x = (origin.within_x + at.x) / side, y = (origin.within_y + at.y) / side;
    const auto last = static_cast<std::int64_t>(extent_.side_pages(static_cast<std::uint8_t>(level))) - 1;
    const auto page = [&](double steps, std::int64_t first) {
        const double far = 1e9;
        return std::clamp<std::int64_t>(
            first + static_cast<std::int64_t>(std::floor(std::clamp(steps, -far, far))), 0, last);
    };
    const std::int64_t left = page(x - margin, origin.page_x), right = page(x + margin, origin.page_x);
    const std::int64_t top = page(y - margin, origin.page_y), bottom = page(y + margin, origin.page_y);
    for (std::int64_t row = top; row <= bottom; ++row)
        for (std::int64_t column = left; column <= right; ++column)
            pages.push_back({static_cast<std::uint8_t>(level), static_cast<std::uint32_t>(column),
                             static_cast<std::uint32_t>(row)});
}

bool PixelReads::add_pages(const Quadrilateral& corners, int level, std::vector<PageKey>& pages) const {
    const Origin& origin = origins_[static_cast<std::size_t>(level)];
    const auto side = static_cast<double>(std::int64_t{page_side_texels} << level);
    const auto last = static_cast<std::int64_t>(extent_.side_pages(static_cast<std::uint8_t>(level))) - 1;
    const auto [low_x, high_x] = std::minmax({corners[0].x, corners[1].x, corners[2].x, corners[3].x});
    const auto [low_y, high_y] = std::minmax({corners[0].y, corners[1].y, corners[2].y, corners[3].y});
    const auto page = [&](double at, double within, std::int64_t first) {
        const double steps = std::floor((within + at) / side), far = 1e10;
        return first + static_cast<std::int64_t>(std::clamp(steps, -far, far));
    };
    std::int64_t left = page(low_x, origin.within_x, origin.page_x),
                 right = page(high_x, origin.within_x, origin.page_x),
                 top = page(low_y, origin.within_y, origin.page_y),
                 bottom = page(high_y, origin.within_y, origin.page_y);
    if (right < 0 || bottom < 0 || left > last || top > last) return true;
    left = std::max<std::int64_t>(left, 0);
    top = std::max<std::int64_t>(top, 0);
    right = std::min(right, last);
    bottom = std::min(bottom, last);
    if (right - left > most_pages || bottom - top > most_pages) return false;
    for (std::int64_t y = top; y <= bottom; ++y) {
        for (std::int64_t x = left; x <= right; ++x) {
            if ((left != right || top != bottom) &&
                is_apart(corners, static_cast<double>(x - origin.page_x) * side - origin.within_x,
                         static_cast<double>(y - origin.page_y) * side - origin.within_y, side))
                continue;
            pages.push_back({static_cast<std::uint8_t>(level), static_cast<std::uint32_t>(x),
                             static_cast<std::uint32_t>(y)});
        }
    }
    return true;
}

/// Whether the gutter of the page under a point serves for all points so far from it; `surely`: even with the
/// shader's floats.
bool PixelReads::is_around(GroundPoint at, GroundPoint reach, int level, bool* surely) const {
    const Origin& origin = origins_[static_cast<std::size_t>(level)];
    const double scale = std::exp2(-level);
    const auto slack = [&](double position, double distance) {
        const double texel = position * scale;
        const double within = texel - page_side_texels * std::floor(texel / page_side_texels);
        return std::min(within - distance * scale - (0.5 - gutter),
                        page_side_texels + gutter - 0.5 - within - distance * scale);
    };
    const double least = std::min(slack(origin.within_x + at.x, std::abs(reach.x)),
                                  slack(origin.within_y + at.y, std::abs(reach.y)));
    *surely = std::abs(least) > texel_margin;
    return least > 0;
}

void PixelReads::add_probes(const Footprint& footprint, double probes, GroundPoint side, int level,
                            std::vector<PageKey>& pages) const {
    add_page(footprint.middle, level, pages);
    bool surely = false;
    if (is_around(footprint.middle, 0.5 * side, level, &surely) && surely) return;
    for (double probe = 1; probe <= probes; ++probe)
        add_page(footprint.middle + (probe / (probes + 1) - 0.5) * side, level, pages);
}

/// shaders/anisotropic.glsl
void PixelReads::add_anisotropic(const Footprint& footprint, std::vector<PageKey>& pages) const {
    const double ratio = footprint.longer / footprint.shorter;
    const bool by_columns = length(footprint.dx) > length(footprint.dy);
    const double few = std::min(std::ceil(ratio * (1 - ratio_margin)), most_anisotropy),
                 many = std::min(std::ceil(ratio * (1 + ratio_margin)), most_anisotropy);
    for (double probes = few; probes <= many; ++probes) {
        const double level = std::log2(footprint.longer / probes) + lod_bias_;
        const int first = clamped(std::floor(level - level_margin)),
                  last = clamped(std::floor(level + level_margin) + 1);
        for (int l = first; l <= last; ++l) {
            if (sampling_.kind == Sampling::Kind::driver_anisotropic) {
                add_page(footprint.middle, l, pages);
                continue;
            }
            add_probes(footprint, probes, by_columns ? footprint.dx : footprint.dy, l, pages);
            if (ratio < 1 + 2 * ratio_margin)
                add_probes(footprint, probes, by_columns ? footprint.dy : footprint.dx, l, pages);
        }
    }
}

/// A pixel's square, or so much of it on each side of its middle.
Quadrilateral PixelReads::pixel_corners(double x, double y, double half) const {
    const double least = std::max(0.3 * nearness(x, y), 1e-300);
    return {ground(x - half, y - half, least), ground(x + half, y - half, least),
            ground(x + half, y + half, least), ground(x - half, y + half, least)};
}

/// shaders/supersample.glsl
void PixelReads::add_supersampled(const Footprint& footprint, double x, double y,
                                  std::vector<PageKey>& pages) const {
    const double level = std::log2(footprint.longer / sampling_.subdivisions) + lod_bias_;
    const int first = clamped(std::floor(level - level_margin)),
              last = clamped(std::floor(level + level_margin) + 1);
    const GroundPoint reach{std::abs(footprint.dx.x) + std::abs(footprint.dy.x),
                            std::abs(footprint.dx.y) + std::abs(footprint.dy.y)};
    bool all_serve = true;
    for (int l = first; l <= last; ++l) {
        bool surely = false;
        all_serve = is_around(footprint.middle, reach, l, &surely) && surely && all_serve;
        add_page(footprint.middle, l, pages);
    }
    if (all_serve) return;
    const double half = 0.5 - 0.5 / sampling_.subdivisions;
    for (int l = first; l <= last; ++l) {
        Quadrilateral samples = pixel_corners(x, y, half);
        const GroundPoint middle = 0.25 * (samples[0] + samples[1] + samples[2] + samples[3]);
        const double grown = texel_margin * std::exp2(l);
        for (GroundPoint& corner : samples) {
            const GroundPoint away = corner - middle;
            corner = corner + (grown / std::max(length(away), 1e-20)) * away;
        }
        add_pages(samples, l, pages);
    }
}

/// The level of a line integral before it is rounded up, but for the bias.
double PixelReads::line_level(const Quadrilateral& corners) const {
    const auto [left, right] = std::minmax({corners[0].x, corners[1].x, corners[2].x, corners[3].x});
    const auto [top, bottom] = std::minmax({corners[0].y, corners[1].y, corners[2].y, corners[3].y});
    const double width = std::max(right - left, 1e-6), height = std::max(bottom - top, 1e-6);
    return line_integral_level(std::min(width, height), std::max(width, height), sampling_.columns) +
           lod_bias_;
}

/// shaders/line_integral.glsl
void PixelReads::add_line_integral(const Footprint& footprint, double x, double y,
                                   std::vector<PageKey>& pages) const {
    Quadrilateral corners = pixel_corners(x, y, 0.5);
    const double dx = length(footprint.dx), dy = length(footprint.dy);
    const GroundPoint grow_x = dx < 1 ? (0.5 / std::max(dx, 1e-6) - 0.5) * footprint.dx : GroundPoint{};
    const GroundPoint grow_y = dy < 1 ? (0.5 / std::max(dy, 1e-6) - 0.5) * footprint.dy : GroundPoint{};
    corners[0] = corners[0] - grow_x - grow_y;
    corners[1] = corners[1] + grow_x - grow_y;
    corners[2] = corners[2] + grow_x + grow_y;
    corners[3] = corners[3] - grow_x + grow_y;
    const double level = line_level(corners);
    for (double l = std::ceil(level - level_margin); l <= std::ceil(level + level_margin); ++l) {
        // Larger than the coarsest level resolves: its middle stands for all of it
        const double shrink = std::min(1.0, std::exp2(extent_.n - std::max(l, 0.0)));
        const int shown = clamped(l);
        Quadrilateral grown = corners;
        for (GroundPoint& corner : grown) {
            const GroundPoint away = shrink * (corner - footprint.middle);
            const double margin = texel_margin * std::exp2(shown) / std::max(length(away), 1e-20);
            corner = footprint.middle + (1 + margin) * away;
        }
        add_pages(grown, shown, pages);
    }
}

void PixelReads::add_pages(int x, int y, std::vector<PageKey>& pages) const {
    const double middle_x = x + 0.5, middle_y = y + 0.5;
    const Footprint here = footprint(middle_x, middle_y);
    // Beyond the extent, but for the soft edge of a pixel, nothing is read
    const PlanePoint& eye = view_.camera().ground;
    const PlanePoint low{}, high{extent_.side_texels(), extent_.side_texels(), 0, 0};
    const double to_edge =
        std::min({here.middle.x - distance_x(eye, low), here.middle.y - distance_y(eye, low),
                  distance_x(eye, high) - here.middle.x, distance_y(eye, high) - here.middle.y});
    if (to_edge < -0.501 * here.longer - 1e-6 * (std::abs(here.middle.x) + std::abs(here.middle.y))) return;
    switch (sampling_.kind) {
        case Sampling::Kind::anisotropic:
        case Sampling::Kind::driver_anisotropic:
            return add_anisotropic(here, pages);
        case Sampling::Kind::line_integral:
            return add_line_integral(here, middle_x, middle_y, pages);
        case Sampling::Kind::supersampled:
            return add_supersampled(here, middle_x, middle_y, pages);
        case Sampling::Kind::nearest_level:
        case Sampling::Kind::isotropic:
            break;
    }
    const bool one = sampling_.kind == Sampling::Kind::nearest_level;
    const double level = std::log2(here.longer) + lod_bias_ + (one ? 0.5 : 0);
    const int first = clamped(std::floor(level - level_margin)),
              last = clamped(std::floor(level + level_margin) + (one ? 0 : 1));
    for (int l = first; l <= last; ++l) add_page(here.middle, l, pages);
}

/// The levels that pixels between these read, unclamped.
PixelReads::Range PixelReads::levels(int left, int top, int right, int bottom) const {
    const double first_x = left + 0.5, last_x = right - 0.5, first_y = top + 0.5, last_y = bottom - 0.5;
    if (sampling_.kind == Sampling::Kind::line_integral)
        return line_integral_levels(first_x, first_y, last_x, last_y);
    // A pixel's side is |∂(s, t) − P·∂w| / w: w is linear in the pixel, and what is above it in the place P.
    // So all are largest at corners, and what is above is nowhere less than in the middle but for a radius.
    const double w[] = {nearness(first_x, first_y), nearness(last_x, first_y), nearness(last_x, last_y),
                        nearness(first_x, last_y)};
    const auto [far, near] = std::minmax({w[0], w[1], w[2], w[3]});
    const GroundPoint corners[] = {ground(first_x, first_y, 1e-300), ground(last_x, first_y, 1e-300),
                                   ground(last_x, last_y, 1e-300), ground(first_x, last_y, 1e-300)};
    const auto above = [&](std::size_t axis) {
        const auto at = [&](GroundPoint p) {
            return GroundPoint{piece_->s[axis] - p.x * piece_->w[axis],
                               piece_->t[axis] - p.y * piece_->w[axis]};
        };
        const GroundPoint at_corner[] = {at(corners[0]), at(corners[1]), at(corners[2]), at(corners[3])};
        const GroundPoint middle = 0.25 * (at_corner[0] + at_corner[1] + at_corner[2] + at_corner[3]);
        Range range;
        double radius = 0;
        for (const GroundPoint corner : at_corner) {
            range.high = std::max(range.high, length(corner));
            radius = std::max(radius, length(corner - middle));
        }
        range.low = std::max(length(middle) - radius, 0.0);
        return range;
    };
    const Range over_x = above(0), over_y = above(1);
    const Range row{over_x.low / near, over_x.high / far}, column{over_y.low / near, over_y.high / far};
    const Range longer{std::max({row.low, column.low, 1e-300}), std::max(row.high, column.high)};
    if (sampling_.kind == Sampling::Kind::anisotropic ||
        sampling_.kind == Sampling::Kind::driver_anisotropic) {
        const Range shorter{std::min(row.low, column.low), std::min(row.high, column.high)};
        // Both of the same pixel: its w does not matter
        const Range skew{over_y.low / std::max(over_x.high, 1e-300),
                         over_y.high / std::max(over_x.low, 1e-300)};
        const double least = skew.high < 1 ? 1 / skew.high : std::max(skew.low, 1.0),
                     most = std::max(skew.high, 1 / std::max(skew.low, 1e-300));
        const auto probes = [](double ratio) { return std::min(std::ceil(ratio), most_anisotropy); };
        const double few = probes(least * (1 - ratio_margin)), many = probes(most * (1 + ratio_margin));
        const double finest = std::max(longer.low / many, shorter.low * least / (least + 1)),
                     coarsest = longer.high / few;
        return {std::floor(std::log2(finest) + lod_bias_ - level_margin),
                std::floor(std::log2(coarsest) + lod_bias_ + level_margin) + 1};
    }
    const bool one = sampling_.kind == Sampling::Kind::nearest_level;
    const double bias = lod_bias_ - std::log2(sampling_.subdivisions) + (one ? 0.5 : 0);
    return {std::floor(std::log2(longer.low) + bias - level_margin),
            std::floor(std::log2(longer.high) + bias + level_margin) + (one ? 0 : 1)};
}

/// Boxes are narrowest where footprints lie along an axis, and are looked at in some places.
PixelReads::Range PixelReads::line_integral_levels(double first_x, double first_y, double last_x,
                                                   double last_y) const {
    Range levels{1e9, -1e9};
    const auto look = [&](double x, double y) {
        Quadrilateral corners = pixel_corners(x, y, 0.5);
        auto [low_x, high_x] = std::minmax({corners[0].x, corners[1].x, corners[2].x, corners[3].x});
        auto [low_y, high_y] = std::minmax({corners[0].y, corners[1].y, corners[2].y, corners[3].y});
        const double width = std::max(high_x - low_x, 0.7), tall = std::max(high_y - low_y, 0.7);
        const double level =
            line_integral_level(std::min(width, tall), std::max(width, tall), sampling_.columns) + lod_bias_;
        levels.low = std::min(levels.low, level);
        levels.high = std::max(levels.high, level);
    };
    for (const double y : {first_y, (first_y + last_y) / 2, last_y}) {
        for (const double x : {first_x, (first_x + last_x) / 2, last_x}) look(x, y);
        const GroundPoint at_first = footprint(first_x, y).dy, at_last = footprint(last_x, y).dy;
        if (at_first.x * at_last.x < 0)
            look(first_x + (last_x - first_x) * at_first.x / (at_first.x - at_last.x), y);
        if (at_first.y * at_last.y < 0)
            look(first_x + (last_x - first_x) * at_first.y / (at_first.y - at_last.y), y);
    }
    const double margin = 0.25 * (levels.high - levels.low) + level_margin;
    return {std::ceil(levels.low - margin), std::ceil(levels.high + margin)};
}

PixelReads::Bounds PixelReads::bounds(int left, int top, int right, int bottom) const {
    const Range found = levels(left, top, right, bottom);
    // Probes lie along straight sides, which towards the eye reach further than the pixel does
    const auto beyond = [&](double x, double y, double slope) {
        const double bend = std::min(slope / nearness(x, y), 2.0);
        return bend > 0 ? std::max(0.5, 0.44 / (1 - 0.44 * bend)) : 0.5;
    };
    const double first_x = left + 0.5, last_x = right - 0.5, first_y = top + 0.5, last_y = bottom - 0.5;
    const double slope_x = piece_->w[0], slope_y = piece_->w[1];
    const double before_x = first_x -
                            std::max(beyond(first_x, first_y, -slope_x), beyond(first_x, last_y, -slope_x)),
                 after_x =
                     last_x + std::max(beyond(last_x, first_y, slope_x), beyond(last_x, last_y, slope_x)),
                 before_y = first_y -
                            std::max(beyond(first_x, first_y, -slope_y), beyond(last_x, first_y, -slope_y)),
                 after_y =
                     last_y + std::max(beyond(first_x, last_y, slope_y), beyond(last_x, last_y, slope_y));
    const auto corner = [&](double x, double y, double middle_x, double middle_y) {
        return ground(x, y, std::max(0.3 * nearness(middle_x, middle_y), 1e-300));
    };
    Bounds bounds{clamped(found.low),
                  clamped(found.high),
                  {corner(before_x, before_y, first_x, first_y), corner(after_x, before_y, last_x, first_y),
                   corner(after_x, after_y, last_x, last_y), corner(before_x, after_y, first_x, last_y)}};
    const double grown = texel_margin * std::exp2(bounds.coarsest) + 0.5;
    const GroundPoint centre =
        0.25 * (bounds.ground[0] + bounds.ground[1] + bounds.ground[2] + bounds.ground[3]);
    for (GroundPoint& point : bounds.ground) {
        const GroundPoint away = point - centre;
        point = point + (2 * grown / std::max(length(away), 1e-20)) * away;
    }
    return bounds;
}

}  // namespace tessera
