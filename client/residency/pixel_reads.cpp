#include "client/residency/pixel_reads.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "client/residency/pixel_margins.h"
#include "client/residency/quick_math.h"

namespace tessera {
namespace {

constexpr double gutter = 4;

}  // namespace

PixelReads::PixelReads(const PlaneView& view, Extent extent, double lod_bias, const Sampling& sampling)
    : view_{view},
      extent_{extent},
      lod_bias_{lod_bias},
      low_scale_{std::exp2(lod_bias - level_margin)},
      high_scale_{std::exp2(lod_bias + level_margin)},
      sampling_{sampling} {
    if (!view.pieces().empty()) look_at(view.pieces().front());
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

void PixelReads::look_at(const FlatPiece& piece) {
    if (piece_ == &piece) return;
    piece_ = &piece;
    const auto row = [](const std::array<double, 3>& r) { return Vector3{r[0], r[1], r[2]}; };
    const Vector3 s = row(piece.s), t = row(piece.t), w = row(piece.w);
    to_picture_ = {cross(t, w), cross(w, s), cross(s, t)};
    if (dot(to_picture_.one, w) < 0) {
        const Vector3 zero{};
        to_picture_ = {zero - to_picture_.x, zero - to_picture_.y, zero - to_picture_.one};
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
    const double scale = power_of_two(-level) / page_side_texels;
    const double margin = texel_margin / page_side_texels;
    const double x = (origin.within_x + at.x) * scale, y = (origin.within_y + at.y) * scale;
    const auto last = static_cast<std::int64_t>(extent_.side_pages(static_cast<std::uint8_t>(level))) - 1;
    const auto page = [&](double steps, std::int64_t first) {
        return std::clamp<std::int64_t>(first + floor_of(steps), 0, last);
    };
    const std::int64_t left = page(x - margin, origin.page_x), right = page(x + margin, origin.page_x);
    const std::int64_t top = page(y - margin, origin.page_y), bottom = page(y + margin, origin.page_y);
    for (std::int64_t row = top; row <= bottom; ++row)
        for (std::int64_t column = left; column <= right; ++column)
            pages.push_back({static_cast<std::uint8_t>(level), static_cast<std::uint32_t>(column),
                             static_cast<std::uint32_t>(row)});
}

/// Whether the gutter of the page under a point serves for all points so far from it; `surely`: even with the
/// shader's floats.
bool PixelReads::is_around(GroundPoint at, GroundPoint reach, int level, bool* surely) const {
    const Origin& origin = origins_[static_cast<std::size_t>(level)];
    const double scale = power_of_two(-level);
    const auto slack = [&](double position, double distance) {
        const double texel = position * scale;
        const double within =
            texel - page_side_texels * static_cast<double>(floor_of(texel * (1.0 / page_side_texels)));
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
        const double longer = footprint.longer / probes;
        const int first = clamped(floor_log2(longer * low_scale_)),
                  last = clamped(floor_log2(longer * high_scale_) + 1);
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
    const double longer = footprint.longer / sampling_.subdivisions;
    const int first = clamped(floor_log2(longer * low_scale_)),
              last = clamped(floor_log2(longer * high_scale_) + 1);
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
        const double grown = texel_margin * power_of_two(l);
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
    return std::log2(
               line_integral_column(std::min(width, height), std::max(width, height), sampling_.columns)) +
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
            const double margin = texel_margin * power_of_two(shown) / std::max(length(away), 1e-20);
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
    const double longer = here.longer * (one ? std::numbers::sqrt2 : 1);
    const int first = clamped(floor_log2(longer * low_scale_)),
              last = clamped(floor_log2(longer * high_scale_) + (one ? 0 : 1));
    for (int l = first; l <= last; ++l) add_page(here.middle, l, pages);
}

}  // namespace tessera
