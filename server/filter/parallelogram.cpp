#include "server/filter/parallelogram.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

std::int32_t floor_of(double x) noexcept {
    const auto truncated = static_cast<std::int32_t>(x);
    return static_cast<double>(truncated) > x ? truncated - 1 : truncated;
}

}  // namespace

FootprintTaps::Moments FootprintTaps::moments(const ConvexPolygon& piece, double u, double v) noexcept {
    Moments sum;
    for (int k = 0; k < piece.count; ++k) {
        const TexelPoint& from = piece.corners[k];
        const TexelPoint& to = piece.corners[k + 1 == piece.count ? 0 : k + 1];
        const TexelPoint a{from.x - u, from.y - v}, b{to.x - u, to.y - v};
        const double cross = a.x * b.y - b.x * a.y;
        sum.area += cross;
        sum.u += cross * (a.x + b.x);
        sum.v += cross * (a.y + b.y);
        sum.uv += cross * (a.x * b.y + 2 * (a.x * a.y + b.x * b.y) + b.x * a.y);
    }
    return {sum.area / 2, sum.u / 6, sum.v / 6, sum.uv / 24};
}

/// Shares out the moments of a piece of the square between the centres of texels (i, j) and (i + 1, j + 1).
void FootprintTaps::add(std::int32_t i, std::int32_t j, const Moments& m) noexcept {
    const auto at = [&](std::int32_t x, std::int32_t y) -> double& {
        x = std::clamp(x, 0, width_ - 1) - left_;
        y = std::clamp(y, 0, height_ - 1) - top_;
        return window_[static_cast<std::size_t>(y) * static_cast<std::size_t>(window_width_) +
                       static_cast<std::size_t>(x)];
    };
    at(i, j) += m.area - m.u - m.v + m.uv;
    at(i + 1, j) += m.u - m.uv;
    at(i, j + 1) += m.v - m.uv;
    at(i + 1, j + 1) += m.uv;
}

void FootprintTaps::add_strip(const ConvexPolygon& strip, std::int32_t j) noexcept {
    double least = strip.corners[0].x, most = least;
    // Where the strip has whole edges along both its lines, the squares between them are whole
    double upper_from = 1, upper_to = 0, lower_from = 1, lower_to = 0;
    const auto widen = [](double u, double& from, double& to) {
        if (from > to) from = to = u;
        from = std::min(from, u);
        to = std::max(to, u);
    };
    for (int k = 0; k < strip.count; ++k) {
        const TexelPoint& p = strip.corners[k];
        least = std::min(least, p.x);
        most = std::max(most, p.x);
        if (p.y == j) widen(p.x, upper_from, upper_to);
        if (p.y == j + 1) widen(p.x, lower_from, lower_to);
    }
    const bool spans = upper_from <= upper_to && lower_from <= lower_to;
    const double whole_from = std::max(upper_from, lower_from), whole_to = std::min(upper_to, lower_to);

    const std::int32_t first = floor_of(least), last = floor_of(most);
    ConvexPolygon rest = strip, piece, beyond;
    for (std::int32_t i = first; i <= last; ++i) {
        if (spans && i >= whole_from && i + 1 <= whole_to) {
            add(i, j, {1, 0.5, 0.5, 0.25});
            continue;
        }
        cut<true, true>(rest, i, beyond);
        cut<true, false>(beyond, i + 1, piece);
        if (piece.count >= 3) add(i, j, moments(piece, i, j));
        rest = beyond;
    }
}

std::span<const Tap> FootprintTaps::of(const Parallelogram& f) {
    taps_.clear();
    const double cross = f.along_x * f.across_y - f.along_y * f.across_x;
    if (!(std::abs(cross) > 0) || !std::isfinite(cross) || !std::isfinite(f.x) || !std::isfinite(f.y))
        return taps_;

    // Corners in positive order, inside the image, counted from the first texel's centre on
    ConvexPolygon polygon, clipped;
    polygon.count = 4;
    polygon.corners[0] = {f.x, f.y};
    polygon.corners[1] = {f.x + f.along_x, f.y + f.along_y};
    polygon.corners[2] = {f.x + f.along_x + f.across_x, f.y + f.along_y + f.across_y};
    polygon.corners[3] = {f.x + f.across_x, f.y + f.across_y};
    if (cross < 0) std::swap(polygon.corners[1], polygon.corners[3]);
    cut<true, true>(polygon, 0, clipped);
    cut<true, false>(clipped, width_, polygon);
    cut<false, true>(polygon, 0, clipped);
    cut<false, false>(clipped, height_, polygon);
    if (polygon.count < 3) return taps_;
    double least_u = 1e300, most_u = -1e300, least_v = 1e300, most_v = -1e300;
    for (int k = 0; k < polygon.count; ++k) {
        TexelPoint& p = polygon.corners[k];
        p.x -= 0.5;
        p.y -= 0.5;
        least_u = std::min(least_u, p.x);
        most_u = std::max(most_u, p.x);
        least_v = std::min(least_v, p.y);
        most_v = std::max(most_v, p.y);
    }
    if (!(least_u <= most_u)) return taps_;

    left_ = std::max(floor_of(least_u), 0);
    top_ = std::max(floor_of(least_v), 0);
    window_width_ = std::min(floor_of(most_u) + 1, width_ - 1) - left_ + 1;
    window_height_ = std::min(floor_of(most_v) + 1, height_ - 1) - top_ + 1;
    window_.assign(static_cast<std::size_t>(window_width_) * static_cast<std::size_t>(window_height_), 0.0);

    // Strip after strip, each cut into its squares
    ConvexPolygon rest = polygon, strip, below;
    const std::int32_t last = floor_of(most_v);
    for (std::int32_t j = floor_of(least_v); j <= last; ++j) {
        cut<false, true>(rest, j, below);
        cut<false, false>(below, j + 1, strip);
        if (strip.count >= 3) add_strip(strip, j);
        rest = below;
    }

    const double* weight = window_.data();
    for (std::int32_t y = top_; y < top_ + window_height_; ++y)
        for (std::int32_t x = left_; x < left_ + window_width_; ++x, ++weight)
            if (*weight > 0) taps_.push_back({y * width_ + x, *weight});
    return taps_;
}

}  // namespace tessera
