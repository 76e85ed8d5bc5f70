#include "shared/math/footprint_from_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace tessera {
namespace {

constexpr double largest_number = 0x1p100;
constexpr double farthest_texel = 0x1p39;

constexpr WorldVector operator+(WorldVector a, WorldVector b) noexcept {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr WorldVector operator-(WorldVector a, WorldVector b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr WorldVector operator*(double s, WorldVector a) noexcept { return {s * a.x, s * a.y, s * a.z}; }
constexpr double dot(WorldVector a, WorldVector b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr WorldVector cross(WorldVector a, WorldVector b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(WorldVector a) noexcept { return std::sqrt(dot(a, a)); }

Error wrong(const std::string& why) { return {ErrorCode::invalid_input, why}; }

Result<void> check_numbers(const RayDifferentials& rays, const TexturedPlane& plane) {
    const auto sane = [](double v) { return std::fabs(v) <= largest_number; };  // false for NaN
    const struct {
        const char* name;
        WorldVector value;
    } vectors[] = {{"origin", rays.origin},       {"direction", rays.direction},
                   {"origin_dx", rays.origin_dx}, {"direction_dx", rays.direction_dx},
                   {"origin_dy", rays.origin_dy}, {"direction_dy", rays.direction_dy},
                   {"point", plane.point},        {"per_s", plane.per_s},
                   {"per_t", plane.per_t},        {"texel", {plane.texel.x, plane.texel.y, 0}}};
    for (const auto& [name, v] : vectors)
        if (!sane(v.x) || !sane(v.y) || !sane(v.z))
            return wrong(std::string{name} + ": is not a finite number within ±2^100");
    return {};
}

/// The plane seen from a ray's origin: `normal` has length 1 and points away from the origin.
struct Seen {
    WorldVector normal;
    double height = 0;   ///< Of the origin over the plane, along the normal: more than 0.
    double descent = 0;  ///< Of the direction towards the plane: more than 0.
};

/// World to texels: the least-squares solution of per_s·s + per_t·t = offset.
struct ToTexels {
    WorldVector s, t;
    TexelPoint operator()(WorldVector offset) const noexcept { return {dot(s, offset), dot(t, offset)}; }
};

/// Where the ray that is `origin_offset` and `direction_offset` off the middle one meets the plane, from
/// `from`; drawn back towards the middle where the plane is too far off there. Along the way to the corner,
/// height and descent change linearly, so each limit is a division.
WorldVector meet(const RayDifferentials& rays, const Seen& seen, WorldVector from, WorldVector origin_offset,
                 WorldVector direction_offset) noexcept {
    const double lost_height = dot(origin_offset, seen.normal);
    const double more_descent = dot(direction_offset, seen.normal);
    double part = 1;
    // The origin stays on its side of the plane, at least at a farthest_multiple-th of its height
    if (lost_height > 0) part = std::min(part, seen.height * (1 - 1 / farthest_multiple) / lost_height);
    // height / descent <= farthest_multiple · (height / descent of the middle)
    const double middle = seen.height / seen.descent;
    const double nearing = lost_height + farthest_multiple * middle * more_descent;
    if (nearing < 0) part = std::min(part, (farthest_multiple - 1) * seen.height / -nearing);
    const double distance = (seen.height - part * lost_height) / (seen.descent + part * more_descent);
    return rays.origin - from + part * origin_offset + distance * (rays.direction + part * direction_offset);
}

}  // namespace

Result<Footprint> footprint_from_rays(const RayDifferentials& given, const TexturedPlane& plane) {
    if (const auto good = check_numbers(given, plane); !good) return good.error();

    // Lengths of 1 where only directions matter, so that nothing below overflows
    RayDifferentials rays = given;
    const double speed = length(rays.direction);
    if (!(speed > 0)) return wrong("direction: is 0, or too small to tell its direction");
    for (WorldVector* v : {&rays.direction, &rays.direction_dx, &rays.direction_dy}) *v = 1 / speed * *v;
    const double s_length = length(plane.per_s), t_length = length(plane.per_t);
    if (!(s_length > 0)) return wrong("per_s: is 0; give how far the surface goes for one texel");
    if (!(t_length > 0)) return wrong("per_t: is 0; give how far the surface goes for one texel");
    const WorldVector s = 1 / s_length * plane.per_s, t = 1 / t_length * plane.per_t;
    const WorldVector across = cross(s, t);
    const double sine = length(across);
    if (!(sine > 0x1p-40)) return wrong("per_t: runs along per_s; the two must span the plane");

    // The tangent plane, turned towards the ray where it is seen too flat
    Seen seen{1 / sine * across, 0, 0};
    if (dot(rays.direction, seen.normal) < 0) seen.normal = -1 * seen.normal;
    if (const double flat = least_sine - dot(rays.direction, seen.normal); flat > 0)
        seen.normal = seen.normal + flat * rays.direction;
    seen.height = dot(plane.point - rays.origin, seen.normal);
    seen.descent = dot(rays.direction, seen.normal);
    if (!(seen.height > 0))
        return wrong("point: lies behind the ray's origin, or at it; the ray does not meet the plane");

    // Texels per unit of the world, in the directions of s and t
    const double skew = dot(s, t), spread = sine * sine;
    const ToTexels to_texels{1 / (spread * s_length) * (s - skew * t),
                             1 / (spread * t_length) * (t - skew * s)};

    // The four corners of the pixel, in order around, each drawn back into the range of footprints
    Footprint footprint{plane.x, plane.y, {}, plane.slice};
    const WorldVector hit = meet(rays, seen, plane.point, {}, {});
    const TexelPoint from_hit = to_texels(hit);
    const TexelPoint middle{plane.texel.x + from_hit.x, plane.texel.y + from_hit.y};
    constexpr std::array<TexelPoint, 4> pixel{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};
    for (std::size_t i = 0; i < 4; ++i) {
        const auto [px, py] = pixel[i];
        const WorldVector corner = meet(rays, seen, plane.point, px * rays.origin_dx + py * rays.origin_dy,
                                        px * rays.direction_dx + py * rays.direction_dy);
        TexelPoint offset = to_texels(corner - hit);
        const double reach = std::max(std::fabs(offset.x), std::fabs(offset.y));
        if (reach > farthest_texel)
            offset = {offset.x / reach * farthest_texel, offset.y / reach * farthest_texel};
        footprint.corners[i] = {middle.x + offset.x, middle.y + offset.y};
    }

    auto good = check_footprint(footprint);
    if (good) return footprint;
    const FootprintAxes axes = axes_of(footprint);
    Footprint parallelogram = footprint_around(plane.x, plane.y, axes.centre, axes.major, axes.minor);
    parallelogram.slice = plane.slice;
    if (check_footprint(parallelogram)) return parallelogram;
    return good.error();
}

}  // namespace tessera
