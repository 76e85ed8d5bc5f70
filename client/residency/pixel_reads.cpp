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
    : view_{view}, extent_{extent}, lod_bias_{lod_bias}, sampling_{sampling} {
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

double PixelReads::fall_at(double y) const {
    return -(view_.forward().z + (1 - 2 * y / view_.height()) * view_.tangent_y() * view_.up().z);
}

/// Where a place of the picture lies, which near the horizon may be beyond it: as point_at of plane.frag.
GroundPoint PixelReads::ground(double x, double y, double middle_y) const {
    const double fall = std::max({fall_at(y), 0.3 * fall_at(middle_y), 1e-20});
    const double across = (2 * x / view_.width() - 1) * view_.tangent_x();
    const double upwards = (1 - 2 * y / view_.height()) * view_.tangent_y();
    const double reach = view_.camera().height_texels / fall;
    return {reach * (view_.forward().x + across * view_.right().x + upwards * view_.up().x),
            reach * (view_.forward().y + across * view_.right().y + upwards * view_.up().y)};
}

PixelReads::Footprint PixelReads::footprint(double x, double y) const {
    const double fall = fall_at(y);
    const double across = (2 * x / view_.width() - 1) * view_.tangent_x();
    const double upwards = (1 - 2 * y / view_.height()) * view_.tangent_y();
    const GroundPoint ray{view_.forward().x + across * view_.right().x + upwards * view_.up().x,
                          view_.forward().y + across * view_.right().y + upwards * view_.up().y};
    const double scale = view_.camera().height_texels * view_.pixel_step() / fall;
    Footprint made;
    made.middle = (view_.camera().height_texels / fall) * ray;
    made.dx = scale * GroundPoint{view_.right().x, view_.right().y};
    made.dy = (scale / fall) * (fall * GroundPoint{view_.up().x, view_.up().y} + view_.up().z * ray);
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

void PixelReads::add_pages(const Quadrilateral& corners, int level, std::vector<PageKey>& pages) const {
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
    if (right < 0 || bottom < 0 || left > last || top > last) return;
    left = std::max<std::int64_t>(left, 0);
    top = std::max<std::int64_t>(top, 0);
    right = std::min(right, last);
    bottom = std::min(bottom, last);
    if (right - left > most_pages || bottom - top > most_pages) return;
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
Quadrilateral PixelReads::pixel_corners(const Footprint&, double x, double y, double half) const {
    return {ground(x - half, y - half, y), ground(x + half, y - half, y), ground(x + half, y + half, y),
            ground(x - half, y + half, y)};
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
        Quadrilateral samples = pixel_corners(footprint, x, y, half);
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
    Quadrilateral corners = pixel_corners(footprint, x, y, 0.5);
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

PixelReads::Bounds PixelReads::bounds(int left, int top, int right, int bottom) const {
    const double first_x = left + 0.5, last_x = right - 0.5, first_y = top + 0.5, last_y = bottom - 0.5;
    // A pixel's sides on the plane shrink downwards, and away from the picture's sides (PlaneView::level_at)
    const double height = view_.camera().height_texels * view_.pixel_step();
    const auto slope = [&](double x) {
        return std::abs(2 * x / view_.width() - 1) * view_.tangent_x() * view_.up().z;
    };
    const double middle = view_.width() / 2.0;
    const double least_slope =
        first_x < middle && last_x > middle ? 0 : std::min(slope(first_x), slope(last_x));
    const double most_slope = std::max(slope(first_x), slope(last_x));
    const double far = fall_at(first_y), near = fall_at(last_y);
    const Range row{height / near, height / far};
    const Range column{row.low * std::sqrt(1 + least_slope * least_slope) / near,
                       row.high * std::sqrt(1 + most_slope * most_slope) / far};
    const Range longer{std::max(row.low, column.low), std::max(row.high, column.high)};
    const Range shorter{std::min(row.low, column.low), std::min(row.high, column.high)};

    Range levels;
    switch (sampling_.kind) {
        case Sampling::Kind::anisotropic:
        case Sampling::Kind::driver_anisotropic: {
            const Range skew{column.low / row.low, column.high / row.high};  // both of the same rows
            const double least = skew.high < 1 ? 1 / skew.high : std::max(skew.low, 1.0),
                         most = std::max(skew.high, 1 / skew.low);
            const auto probes = [](double ratio) { return std::min(std::ceil(ratio), most_anisotropy); };
            const double few = probes(least * (1 - ratio_margin)), many = probes(most * (1 + ratio_margin));
            const double finest = std::max(longer.low / many, shorter.low * least / (least + 1)),
                         coarsest = longer.high / few;
            levels = {std::floor(std::log2(finest) + lod_bias_ - level_margin),
                      std::floor(std::log2(coarsest) + lod_bias_ + level_margin) + 1};
            break;
        }
        case Sampling::Kind::line_integral: {
            // Boxes are narrowest where footprints lie along an axis, and are looked at in some places
            levels = {1e9, -1e9};
            const auto look = [&](double x, double y) {
                Quadrilateral corners = pixel_corners({}, x, y, 0.5);
                auto [low_x, high_x] = std::minmax({corners[0].x, corners[1].x, corners[2].x, corners[3].x});
                auto [low_y, high_y] = std::minmax({corners[0].y, corners[1].y, corners[2].y, corners[3].y});
                const double width = std::max(high_x - low_x, 0.7), tall = std::max(high_y - low_y, 0.7);
                const double level =
                    line_integral_level(std::min(width, tall), std::max(width, tall), sampling_.columns) +
                    lod_bias_;
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
            levels = {std::ceil(levels.low - margin), std::ceil(levels.high + margin)};
            break;
        }
        default: {
            const bool one = sampling_.kind == Sampling::Kind::nearest_level;
            const double bias = lod_bias_ - std::log2(sampling_.subdivisions) + (one ? 0.5 : 0);
            levels = {std::floor(std::log2(longer.low) + bias - level_margin),
                      std::floor(std::log2(longer.high) + bias + level_margin) + (one ? 0 : 1)};
        }
    }
    // Probes lie along straight sides, which near the horizon reach further down than the pixel does
    const double bend = std::min(view_.pixel_step() * view_.up().z / near, 2.0);
    const double below = last_y + std::max(0.5, 0.44 / (1 - 0.44 * bend));
    const double grown = texel_margin * std::exp2(clamped(levels.high)) + 0.5;
    Bounds found{clamped(levels.low),
                 clamped(levels.high),
                 {ground(left, top, first_y), ground(right, top, first_y), ground(right, below, last_y),
                  ground(left, below, last_y)}};
    const GroundPoint centre = 0.25 * (found.ground[0] + found.ground[1] + found.ground[2] + found.ground[3]);
    for (GroundPoint& corner : found.ground) {
        const GroundPoint away = corner - centre;
        corner = corner + (2 * grown / std::max(length(away), 1e-20)) * away;
    }
    return found;
}

}  // namespace tessera
