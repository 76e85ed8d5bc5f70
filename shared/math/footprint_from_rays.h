#pragma once

#include <cstdint>

#include "shared/math/footprint.h"
#include "shared/result/result.h"

namespace tessera {

/// A point or a direction of the world, in whatever unit the renderer counts.
struct WorldVector {
    double x = 0, y = 0, z = 0;
    bool operator==(const WorldVector&) const = default;
};

/// The ray through the middle of a pixel, and how it changes from there to the next pixel to the right (dx)
/// and below (dy): Igehy, "Tracing ray differentials", SIGGRAPH 1999. For the neighbouring rays that
/// `filtering-procedural-textures` casts, the differences to this one. Origins of a pinhole camera do not
/// change. The direction has any length but 0.
struct RayDifferentials {
    WorldVector origin, direction;
    WorldVector origin_dx, direction_dx;
    WorldVector origin_dy, direction_dy;
};

/// A surface where a ray hits it, as flat as it is there: the tangent plane and the texture on it.
struct TexturedPlane {
    WorldVector point;          ///< Where the ray hits.
    WorldVector per_s, per_t;   ///< How far the surface goes for one texel rightwards, and downwards.
    std::int64_t x = 0, y = 0;  ///< The origin that texels count from: see Footprint.
    TexelPoint texel;           ///< At `point`, from the origin.
    std::int64_t slice = 0;
};

/// A corner of a pixel that sees the plane further off than this many times the middle's distance, or past
/// its horizon, is drawn back towards the middle, as far as that.
inline constexpr double farthest_multiple = 16;

/// A plane that is seen flatter than this (the sine of the angle between ray and plane) counts as turned
/// towards the ray by so much: even a ray along the plane has a footprint.
inline constexpr double least_sine = 0x1p-16;

/// What a pixel must average: where the rays through its four corners, half a pixel off its middle, meet the
/// tangent plane. For a pinhole camera this is just what the pixel covers of the plane.
///  - No differentials: a footprint without area, at the hit.
///  - Past the horizon, or far beyond the hit: see farthest_multiple. Along the plane: see least_sine.
///  - A corner further than 2^39 texels from the middle is drawn back to that.
///  - Where the ray's origin moves so that the four corners are not convex: the parallelogram of the means of
///    opposite sides.
/// The plane's two sides are the same. Errors, invalid_input with the field's name: a number is not finite or
/// beyond ±2^100; the direction is 0; `per_s` and `per_t` span no plane; the plane lies behind the ray's
/// origin; and those of check_footprint.
Result<Footprint> footprint_from_rays(const RayDifferentials& rays, const TexturedPlane& plane);

}  // namespace tessera
