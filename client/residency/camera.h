#pragma once

#include <cmath>
#include <cstdint>

namespace tessera {

/// A point of the plane: texel (x, y) of level 0 plus a fraction of a texel, so that a place near 2^38 is as
/// exact as one near 0. `x` grows rightwards (east), `y` downwards (south).
struct PlanePoint {
    std::int64_t x = 0;
    std::int64_t y = 0;
    double fraction_x = 0;  ///< 0 to below 1
    double fraction_y = 0;

    /// The point (dx, dy) texels further; the result's fractions are 0 to below 1.
    PlanePoint moved(double dx, double dy) const noexcept {
        const double sum_x = fraction_x + dx, sum_y = fraction_y + dy;
        const double whole_x = std::floor(sum_x), whole_y = std::floor(sum_y);
        return {x + static_cast<std::int64_t>(whole_x), y + static_cast<std::int64_t>(whole_y),
                sum_x - whole_x, sum_y - whole_y};
    }
    bool operator==(const PlanePoint&) const = default;
};

/// How many texels `to` lies right of and below `from`; exact to a double's precision of the *difference*.
inline double distance_x(const PlanePoint& from, const PlanePoint& to) noexcept {
    return static_cast<double>(to.x - from.x) + (to.fraction_x - from.fraction_x);
}
inline double distance_y(const PlanePoint& from, const PlanePoint& to) noexcept {
    return static_cast<double>(to.y - from.y) + (to.fraction_y - from.fraction_y);
}

/// An eye above the plane. It never rolls: the horizon is level.
struct Camera {
    PlanePoint ground{};                ///< The point of the plane straight below the eye: the clip centre.
    double height_texels = 512;         ///< Above the plane, more than 0.
    double yaw_degrees = 0;             ///< Compass heading: 0 looks north (−y), 90 east (+x).
    double pitch_degrees = -40;         ///< −90 looks straight down, 0 at the horizon; at most 89.
    double field_of_view_degrees = 50;  ///< Vertical, 1 to 150.
    bool operator==(const Camera&) const = default;
};

}  // namespace tessera
