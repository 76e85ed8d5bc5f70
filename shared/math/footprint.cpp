#include "shared/math/footprint.h"

#include <cmath>
#include <string>
#include <utility>

namespace tessera {

namespace {

constexpr double max_offset = 0x1p40;

constexpr TexelPoint operator-(TexelPoint a, TexelPoint b) noexcept { return {a.x - b.x, a.y - b.y}; }

constexpr double cross(TexelPoint a, TexelPoint b) noexcept { return a.x * b.y - a.y * b.x; }

constexpr double square_length(TexelPoint a) noexcept { return a.x * a.x + a.y * a.y; }

/// The turn at a corner, and how much of it rounding may be: differences and products are each off by a half
/// of a last place of what they are made of.
struct Turn {
    double value = 0, rounding = 0;
};

Turn turn_at(TexelPoint before, TexelPoint corner, TexelPoint after) noexcept {
    const TexelPoint in = corner - before, out = after - corner;
    const double size = std::fabs(corner.x) + std::fabs(corner.y) + std::fabs(before.x) +
                        std::fabs(before.y) + std::fabs(after.x) + std::fabs(after.y);
    const double reach = std::fabs(in.x) + std::fabs(in.y) + std::fabs(out.x) + std::fabs(out.y);
    return {cross(in, out), size * reach * 0x1p-50};
}

}  // namespace

double area_of(const Footprint& footprint) noexcept {
    // Of the two triangles on either side of a diagonal: differences first, so that offsets do not cancel
    const auto& c = footprint.corners;
    return std::fabs(cross(c[2] - c[0], c[3] - c[1])) / 2;
}

FootprintAxes axes_of(const Footprint& footprint) noexcept {
    const auto& c = footprint.corners;
    FootprintAxes axes;
    axes.centre = {(c[0].x + c[1].x + c[2].x + c[3].x) / 4, (c[0].y + c[1].y + c[2].y + c[3].y) / 4};
    const TexelPoint along{(c[1].x - c[0].x + c[2].x - c[3].x) / 2, (c[1].y - c[0].y + c[2].y - c[3].y) / 2};
    const TexelPoint across{(c[3].x - c[0].x + c[2].x - c[1].x) / 2, (c[3].y - c[0].y + c[2].y - c[1].y) / 2};
    axes.major = along;
    axes.minor = across;
    if (square_length(axes.major) < square_length(axes.minor)) std::swap(axes.major, axes.minor);
    return axes;
}

Footprint footprint_around(std::int64_t x, std::int64_t y, TexelPoint centre, TexelPoint along,
                           TexelPoint across) noexcept {
    const auto corner = [&](double a, double b) {
        return TexelPoint{centre.x + a * along.x + b * across.x, centre.y + a * along.y + b * across.y};
    };
    return {x, y, {corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)}, 0};
}

Result<void> check_footprint(const Footprint& footprint) {
    const auto within = [](std::int64_t v) {
        return v >= -max_footprint_origin && v <= max_footprint_origin;
    };
    if (!within(footprint.x) || !within(footprint.y))
        return Error{ErrorCode::invalid_input, "the origin lies beyond ±2^40 texels"};
    for (std::size_t i = 0; i < 4; ++i) {
        const TexelPoint corner = footprint.corners[i];
        if (!std::isfinite(corner.x) || !std::isfinite(corner.y))
            return Error{ErrorCode::invalid_input, "corner " + std::to_string(i) + " is not a finite number"};
        if (std::fabs(corner.x) > max_offset || std::fabs(corner.y) > max_offset)
            return Error{ErrorCode::invalid_input,
                         "corner " + std::to_string(i) + " lies beyond 2^40 texels from the origin"};
    }
    bool left = false, right = false;
    for (std::size_t i = 0; i < 4; ++i) {
        const Turn turn =
            turn_at(footprint.corners[(i + 3) % 4], footprint.corners[i], footprint.corners[(i + 1) % 4]);
        left = left || turn.value < -turn.rounding;
        right = right || turn.value > turn.rounding;
        if (left && right)
            return Error{ErrorCode::invalid_input,
                         "corner " + std::to_string(i) +
                             " makes the footprint not convex; give the corners in order around"};
    }
    return {};
}

}  // namespace tessera
