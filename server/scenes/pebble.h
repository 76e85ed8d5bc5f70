#pragma once

#include <array>
#include <cstdint>

#include "server/scenes/noise.h"

namespace tessera {

/// Linear light, red, green, blue, 0 to 1.
using LinearColor = std::array<double, 3>;

/// One stone, seen from above: where it lies, its shape, and what it is made of. Lengths are in texels of the
/// canvas it is painted on; heights too.
struct Pebble {
    double x = 0, y = 0;            ///< Centre.
    double axis_x = 1, axis_y = 0;  ///< Unit vector along the longer half axis.
    double half_length = 1, half_width = 1, half_height = 1;
    double base = 0;                      ///< Height of the widest cross-section at the centre.
    double tilt_x = 0, tilt_y = 0;        ///< Slope of that cross-section.
    double squareness = 0, flatness = 0;  ///< 0 is an ellipsoid; 1 a pillow, and a table with round edges.
    double taper = 0, roughness = 0;
    struct Facet {
        double direction_x = 1, direction_y = 0, offset = 1, steepness = 0;
    };
    std::array<Facet, 3> facets{};  ///< Planes that cut the dome, in units of the half axes.
    std::uint32_t salt = 0;         ///< Of all its noise.

    LinearColor color{}, second_color{};
    double mottling = 0, speckles = 0, bands = 0, veins = 0;  ///< 0 to 1, strength of each marking.
    double gloss = 0;
};

/// A random stone of the given mean half axis, at the origin, not laid down yet.
Pebble make_pebble(double radius, Dice& dice);

/// The stone's own coordinates of a point `dx`, `dy` from its centre: half axes are 1.
struct PebblePoint {
    double u = 0, v = 0;
};
PebblePoint to_pebble(const Pebble& pebble, double dx, double dy) noexcept;

/// Height of the upper surface there, or `outside`.
inline constexpr double outside = -1e9;
double surface_height(const Pebble& pebble, double dx, double dy) noexcept;

/// The stone's colour there, before light falls on it. `texel` is the size of a texel, so that grains are as
/// fine on large stones as on small ones.
LinearColor surface_color(const Pebble& pebble, double dx, double dy, double texel) noexcept;

/// Half the side of a square around the centre that holds the stone.
double reach(const Pebble& pebble) noexcept;

/// How far the outline is from the centre in a direction, without its irregularities.
double radius_towards(const Pebble& pebble, double dx, double dy) noexcept;

}  // namespace tessera
