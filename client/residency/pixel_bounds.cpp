// What the pixels of a box may read, at most a bit too much.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "client/residency/pixel_margins.h"
#include "client/residency/pixel_reads.h"
#include "client/residency/quick_math.h"

namespace tessera {
namespace {

/// More pages in a row than any window holds: what lies beyond it is shown by coarser pages.
constexpr std::int64_t most_pages = 256;

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

bool PixelReads::add_pages(const Quadrilateral& corners, int level, std::vector<PageKey>& pages) const {
    const Origin& origin = origins_[static_cast<std::size_t>(level)];
    const auto side = static_cast<double>(std::int64_t{page_side_texels} << level);
    const auto last = static_cast<std::int64_t>(extent_.side_pages(static_cast<std::uint8_t>(level))) - 1;
    const auto [low_x, high_x] = std::minmax({corners[0].x, corners[1].x, corners[2].x, corners[3].x});
    const auto [low_y, high_y] = std::minmax({corners[0].y, corners[1].y, corners[2].y, corners[3].y});
    const double scale = power_of_two(-level) / page_side_texels;
    const auto page = [&](double at, double within, std::int64_t first) {
        return first + floor_of((within + at) * scale);
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

bool PixelReads::may_read(int left, int top, int right, int bottom, PageKey page) const {
    const Range found = levels(left, top, right, bottom);
    const int coarsest = clamped(found.high);
    if (page.level < clamped(found.low) || page.level > coarsest) return false;
    const auto last = extent_.side_pages(page.level) - 1;
    // What lies beyond the extent reads its outermost pages
    if (page.x == 0 || page.y == 0 || page.x == last || page.y == last) return true;
    const Square square = square_of(page);
    const Quadrilateral ground = ground_of(left, top, right, bottom, coarsest);
    const auto [low_x, high_x] = std::minmax({ground[0].x, ground[1].x, ground[2].x, ground[3].x});
    const auto [low_y, high_y] = std::minmax({ground[0].y, ground[1].y, ground[2].y, ground[3].y});
    return low_x <= square.left + square.side && high_x >= square.left && low_y <= square.top + square.side &&
           high_y >= square.top && !is_apart(ground, square.left, square.top, square.side);
}

PixelReads::Part PixelReads::part_of(PageKey page) const {
    const auto last = extent_.side_pages(page.level) - 1;
    if (page.x == 0 || page.y == 0 || page.x == last || page.y == last) return {};
    const Square square = square_of(page);
    const double grown = 2 * texel_margin * power_of_two(page.level) + 2;  // footprints grow to a texel
    Part part{1e9, 1e9, -1e9, -1e9};
    for (int corner = 0; corner < 4; ++corner) {
        const double x = corner % 2 == 0 ? square.left - grown : square.left + square.side + grown,
                     y = corner / 2 == 0 ? square.top - grown : square.top + square.side + grown;
        const auto at = [&](double Vector3::*axis) {
            return x * to_picture_.x.*axis + y * to_picture_.y.*axis + to_picture_.one.*axis;
        };
        const double depth = at(&Vector3::z);
        // Behind the eye, or nearly beside it
        if (!(depth > 1e-9 * (std::abs(x * to_picture_.x.z) + std::abs(y * to_picture_.y.z) +
                              std::abs(to_picture_.one.z))))
            return {};
        const double across = at(&Vector3::x) / depth + view_.width() / 2.0,
                     down = at(&Vector3::y) / depth + view_.height() / 2.0;
        part.left = std::min(part.left, across);
        part.right = std::max(part.right, across);
        part.top = std::min(part.top, down);
        part.bottom = std::max(part.bottom, down);
    }
    // A pixel's probes reach that far beyond it, see bounds()
    constexpr double reach = 4;
    return {part.left - reach, part.top - reach, part.right + reach, part.bottom + reach};
}

PixelReads::Square PixelReads::square_of(PageKey page) const {
    const Origin& origin = origins_[page.level];
    const auto side = static_cast<double>(std::int64_t{page_side_texels} << page.level);
    return {static_cast<double>(page.x - origin.page_x) * side - origin.within_x,
            static_cast<double>(page.y - origin.page_y) * side - origin.within_y, side};
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
        return {static_cast<double>(floor_log2(finest * low_scale_)),
                static_cast<double>(floor_log2(coarsest * high_scale_) + 1)};
    }
    const bool one = sampling_.kind == Sampling::Kind::nearest_level;
    const double scale = (one ? std::numbers::sqrt2 : 1) / sampling_.subdivisions;
    return {static_cast<double>(floor_log2(longer.low * scale * low_scale_)),
            static_cast<double>(floor_log2(longer.high * scale * high_scale_) + (one ? 0 : 1))};
}

/// Boxes are narrowest where footprints lie along an axis, and are looked at in some places.
PixelReads::Range PixelReads::line_integral_levels(double first_x, double first_y, double last_x,
                                                   double last_y) const {
    Range sizes{1e300, 1e-300};  // of a column, which the level grows with
    const auto look = [&](double x, double y) {
        Quadrilateral corners = pixel_corners(x, y, 0.5);
        auto [low_x, high_x] = std::minmax({corners[0].x, corners[1].x, corners[2].x, corners[3].x});
        auto [low_y, high_y] = std::minmax({corners[0].y, corners[1].y, corners[2].y, corners[3].y});
        const double width = std::max(high_x - low_x, 0.7), tall = std::max(high_y - low_y, 0.7);
        const double size =
            line_integral_column(std::min(width, tall), std::max(width, tall), sampling_.columns);
        sizes.low = std::min(sizes.low, size);
        sizes.high = std::max(sizes.high, size);
    };
    const double rows[] = {first_y, (first_y + last_y) / 2, last_y};
    for (const double y : std::span{rows}.first(first_y == last_y ? 1 : 3)) {
        for (const double x : {first_x, (first_x + last_x) / 2, last_x}) look(x, y);
        const GroundPoint at_first = footprint(first_x, y).dy, at_last = footprint(last_x, y).dy;
        if (at_first.x * at_last.x < 0)
            look(first_x + (last_x - first_x) * at_first.x / (at_first.x - at_last.x), y);
        if (at_first.y * at_last.y < 0)
            look(first_x + (last_x - first_x) * at_first.y / (at_first.y - at_last.y), y);
    }
    const Range levels{std::log2(sizes.low) + lod_bias_, std::log2(sizes.high) + lod_bias_};
    const double margin = 0.25 * (levels.high - levels.low) + level_margin;
    return {std::ceil(levels.low - margin), std::ceil(levels.high + margin)};
}

PixelReads::Bounds PixelReads::bounds(int left, int top, int right, int bottom) const {
    const Range found = levels(left, top, right, bottom);
    const int finest = clamped(found.low), coarsest = clamped(found.high);
    return {finest, coarsest, ground_of(left, top, right, bottom, coarsest)};
}

/// Where the probes of these pixels may lie, on this level or finer ones.
Quadrilateral PixelReads::ground_of(int left, int top, int right, int bottom, int coarsest) const {
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
    Quadrilateral reached{
        corner(before_x, before_y, first_x, first_y), corner(after_x, before_y, last_x, first_y),
        corner(after_x, after_y, last_x, last_y), corner(before_x, after_y, first_x, last_y)};
    const double grown = texel_margin * power_of_two(coarsest) + 0.5;
    const GroundPoint centre = 0.25 * (reached[0] + reached[1] + reached[2] + reached[3]);
    for (GroundPoint& point : reached) {
        const GroundPoint away = point - centre;
        point = point + (2 * grown / std::max(length(away), 1e-20)) * away;
    }
    return reached;
}

}  // namespace tessera
