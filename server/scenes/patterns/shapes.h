#pragma once

#include "server/scenes/patterns/canvas.h"

namespace tessera::painting {

/// Colours between three: `low` at 0, `middle` at 0.5, `high` at 1.
LinearColor blend(const LinearColor& low, const LinearColor& middle, const LinearColor& high,
                  double t) noexcept;
LinearColor blend(const LinearColor& low, const LinearColor& high, double t) noexcept;
/// Times a lightness, and `warmth` of red against blue.
LinearColor tinted(const LinearColor& color, double lightness, double warmth = 0) noexcept;

struct Direction {
    double x = 1, y = 0;
};
/// Uniform, without sines: a point in the unit disc, normalised.
Direction any_direction(Dice& dice) noexcept;
/// Turned by a right angle.
constexpr Direction beside(Direction d) noexcept { return {-d.y, d.x}; }
/// `share` of a turn further, about: along the square's rim, normalised.
Direction turned(Direction d, double share) noexcept;

/// A long thin thing from its root: grass, a stalk, a petal. Lengths in texels.
struct Blade {
    double x = 0, y = 0;  ///< Root.
    Direction along{};
    double length = 8, half_width = 0.7;
    double bend = 0;      ///< How far its tip is off the straight line.
    double widest = 0.3;  ///< Where along it, 0 to 1.
    double blunt = 0;     ///< 0: a point at its end; 1: round.
    double base = 0,
           lift = 3;  ///< Heights of root, and of the rest above it: a bow that sinks back by `sag`.
    double sag = 0;
    double crease = 0.4;  ///< Along its middle: above 0 a ridge, below a groove.
    LinearColor root_color{}, middle_color{}, tip_color{};
    double line = 0;  ///< A lighter line along its middle, 0 to 1.
};
Box box_of(const Blade& blade) noexcept;
void draw_blade(Canvas& canvas, const Blade& blade);

/// A round thing: a stone, a berry, a cap. Heights in texels.
struct Dome {
    double x = 0, y = 0;
    Direction along{};
    double half_length = 2, half_width = 2, height = 2, base = 0;
    double rough = 0;  ///< Of its outline and surface, 0 to 1.
    double flat = 0;   ///< 0: a ball; 1: a table.
    LinearColor color{}, second_color{};
    double mottling = 0;  ///< 0 to 1, how much of the second colour.
    std::uint32_t salt = 0;
};
void draw_dome(Canvas& canvas, const Dome& dome);
Box box_of(const Dome& dome) noexcept;

}  // namespace tessera::painting
