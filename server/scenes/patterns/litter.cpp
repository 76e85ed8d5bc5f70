#include "server/scenes/patterns/litter.h"

#include <array>
#include <cmath>

#include "server/scenes/patterns/leaf.h"
#include "server/scenes/patterns/meadow.h"
#include "server/scenes/patterns/scatter.h"
#include "shared/math/hash.h"

namespace tessera::painting {
namespace {

Thing moved(const Blade& blade) {
    return {box_of(blade), [blade](Canvas& canvas, double x, double y) {
                Blade here = blade;
                here.x = x;
                here.y = y;
                draw_blade(canvas, here);
            }};
}

Thing make_needle(Dice& dice) {
    const double light = dice.uniform(0.6, 1.3), warm = dice.uniform(-0.1, 0.15);
    return moved({.along = any_direction(dice),
                  .length = dice.uniform(7, 15),
                  .half_width = dice.uniform(0.4, 0.65),
                  .bend = dice.uniform(-1.2, 1.2),
                  .widest = 0.3,
                  .base = dice.uniform(0.2, 1.4),
                  .lift = dice.uniform(0, 0.8),
                  .crease = 0.7,
                  .root_color = tinted({0.14, 0.075, 0.030}, light, warm),
                  .middle_color = tinted({0.26, 0.135, 0.050}, light, warm),
                  .tip_color = tinted({0.20, 0.10, 0.04}, light, warm)});
}

Thing make_twig(Dice& dice) {
    const double light = dice.uniform(0.7, 1.2);
    return moved({.along = any_direction(dice),
                  .length = dice.uniform(22, 40),
                  .half_width = dice.uniform(0.9, 1.7),
                  .bend = dice.uniform(-5, 5),
                  .widest = 0.2,
                  .blunt = 0.5,
                  .base = 1.2,
                  .lift = dice.uniform(0.5, 1.5),
                  .sag = 0.6,
                  .crease = 1.0,
                  .root_color = tinted({0.15, 0.10, 0.065}, light),
                  .middle_color = tinted({0.20, 0.14, 0.095}, light),
                  .tip_color = tinted({0.12, 0.08, 0.05}, light)});
}

/// A little star of moss.
Thing make_moss(Dice& dice) {
    const std::uint64_t key = dice.bits();
    return {{-3.6, -3.6, 3.6, 3.6}, [key](Canvas& canvas, double x, double y) {
                Dice own{key};
                const Direction start = any_direction(own);
                const double light = own.uniform(0.65, 1.3), warm = own.uniform(-0.1, 0.2),
                             base = own.uniform(0.4, 2.6);
                for (int i = 0; i < 6; ++i)
                    draw_blade(canvas, {.x = x,
                                        .y = y,
                                        .along = turned(start, (i + own.uniform(-0.2, 0.2)) / 6.0),
                                        .length = own.uniform(1.8, 3.0),
                                        .half_width = 0.62,
                                        .bend = own.uniform(-0.5, 0.5),
                                        .widest = 0.35,
                                        .base = base,
                                        .lift = 0.9,
                                        .sag = 0.9,
                                        .crease = 0.6,
                                        .root_color = tinted({0.16, 0.23, 0.035}, light, warm),
                                        .middle_color = tinted({0.10, 0.175, 0.022}, light, warm),
                                        .tip_color = tinted({0.045, 0.10, 0.014}, light, warm)});
            }};
}

Thing make_crumb(Dice& dice) {
    Dome dome;
    dome.along = any_direction(dice);
    const double r = 0.7 + 1.6 * dice.uniform(0, 1) * dice.uniform(0, 1);
    dome.half_length = r * dice.uniform(1, 1.5);
    dome.half_width = r;
    dome.height = r * 0.7;
    dome.rough = 1;
    const double light = dice.uniform(0.5, 1.5);
    dome.color = tinted({0.105, 0.070, 0.042}, light, dice.uniform(-0.1, 0.1));
    dome.salt = static_cast<std::uint32_t>(dice.bits());
    return {box_of(dome), [dome](Canvas& canvas, double x, double y) {
                Dome here = dome;
                here.x = x;
                here.y = y;
                here.base = canvas.height(x, y) - 0.2;
                draw_dome(canvas, here);
            }};
}

}  // namespace

Rgba8Image paint_forest_floor(std::int32_t number, std::int32_t side) {
    Canvas tile{side, 2};
    const std::uint64_t own = hash(3, stream("forest floor"), number, 0);
    const auto salt = static_cast<std::uint32_t>(own >> 9);
    const double size = side, area = size * size / 16384;
    tile.fill([&](double x, double y, Paint& paint) {
        const double lump = tile_noise(x, y, size, 6, 601, salt, 5);
        const double fine = noise(x * 0.8, y * 0.8, salt + 1) * inner(x, y, size, 4);
        paint.height = 1.8 * lump + 0.25 * fine;
        paint.color =
            tinted(blend({0.032, 0.024, 0.013}, {0.085, 0.060, 0.034}, 0.5 + 0.55 * lump), 1 + 0.3 * fine);
    });
    const auto mossy = [&](double x, double y) {
        return tile_noise(x, y, size, 7, 611, salt + 2, 3) > -0.16;
    };
    const auto lay = [&](const char* name, double count, std::function<Thing(Dice&)> make,
                         std::function<bool(double, double)> may_be = nullptr) {
        scatter(tile, {.border_key = stream(name),
                       .own_key = hash(own, stream(name), 0, 0),
                       .count = count * area,
                       .make = [make](Dice& dice, double, double) { return make(dice); },
                       .may_be = std::move(may_be)});
    };
    lay("crumbs", 420, make_crumb);
    lay("needles", 210, make_needle);
    lay("moss", 1150, make_moss, mossy);
    lay("needles on top", 26, [](Dice& dice) { return make_needle(dice); });
    scatter(tile, {.border_key = 0,
                   .own_key = hash(own, stream("twigs"), 0, 0),
                   .count = number % 3 == 0 ? 5.0 : 2.0,
                   .make = [](Dice& dice, double, double) { return make_twig(dice); },
                   .crossing = false});
    return tile.develop({.sun = 1.0, .sky = 0.9, .shade = 0.9, .glow = 0.15, .level = 1.0});
}

Rgba8Image paint_lawn(std::int32_t number, std::int32_t side) {
    Canvas tile{side, 2};
    const std::uint64_t own = hash(4, stream("lawn"), number, 0);
    draw_soil(tile, 611, static_cast<std::uint32_t>(own >> 7));
    plant_meadow(tile, number == 3 ? 1 : 0, stream("lawn border"), own, nullptr);
    return tile.develop({.sun = 0.95, .sky = 0.9, .shade = 0.8, .glow = 0.18, .level = 0.85});
}

Rgba8Image paint_autumn_leaf(std::int32_t number, std::int32_t side) {
    using Kind = Leaf::Kind;
    const std::array<Leaf, leaf_patterns> leaves{{
        {Kind::beech,
         {0.62, 0.30, 0.055},
         {0.50, 0.150, 0.022},
         {0.16, 0.06, 0.018},
         0.45,
         0.6,
         11},  // copper
        {Kind::maple,
         {0.60, 0.090, 0.026},
         {0.48, 0.026, 0.014},
         {0.20, 0.016, 0.012},
         0.45,
         0.5,
         22},  // red
        {Kind::maple,
         {0.84, 0.48, 0.050},
         {0.72, 0.200, 0.020},
         {0.42, 0.110, 0.015},
         0.40,
         0.55,
         33},                                                                                        // orange
        {Kind::oak, {0.46, 0.26, 0.090}, {0.30, 0.140, 0.040}, {0.10, 0.05, 0.020}, 0.55, 0.7, 44},  // brown
        {Kind::birch,
         {0.82, 0.62, 0.080},
         {0.80, 0.500, 0.035},
         {0.35, 0.17, 0.020},
         0.50,
         0.45,
         55},  // yellow
        {Kind::ginkgo,
         {0.84, 0.68, 0.110},
         {0.86, 0.590, 0.040},
         {0.55, 0.33, 0.030},
         0.25,
         0.35,
         66},  // gold
        {Kind::beech,
         {0.42, 0.44, 0.070},
         {0.56, 0.400, 0.040},
         {0.26, 0.11, 0.020},
         0.60,
         0.5,
         77},  // turning
        {Kind::willow,
         {0.66, 0.52, 0.110},
         {0.58, 0.380, 0.060},
         {0.20, 0.10, 0.025},
         0.60,
         0.6,
         88},  // pale
    }};
    return paint_leaf(leaves[static_cast<std::size_t>(number)], side);
}

}  // namespace tessera::painting
