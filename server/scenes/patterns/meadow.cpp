#include "server/scenes/patterns/meadow.h"

#include <array>
#include <cmath>

#include "server/scenes/patterns/shapes.h"
#include "shared/math/hash.h"

namespace tessera::painting {
namespace {

/// Several petals round a middle.
struct Blossom {
    int petals = 5;
    double radius = 3, petal_width = 1.2, base = 5, cup = 0.8;
    double blunt = 1, widest = 0.6;
    LinearColor inner_color{}, outer_color{}, middle_color{};
    double middle = 1;  ///< Radius.
    double crease = -0.25;
};

void draw_blossom(Canvas& canvas, double x, double y, const Blossom& blossom, Dice dice) {
    const Direction start = any_direction(dice);
    for (int i = 0; i < blossom.petals; ++i) {
        const Direction d = turned(start, (i + dice.uniform(-0.12, 0.12)) / blossom.petals);
        const double light = dice.uniform(0.88, 1.08);
        Blade petal{.x = x + d.x * blossom.middle * 0.3,
                    .y = y + d.y * blossom.middle * 0.3,
                    .along = d,
                    .length = blossom.radius * dice.uniform(0.9, 1.1),
                    .half_width = blossom.petal_width,
                    .bend = dice.uniform(-0.3, 0.3),
                    .widest = blossom.widest,
                    .blunt = blossom.blunt,
                    .base = blossom.base + 0.05 * i,
                    .lift = blossom.cup,
                    .sag = 0.4,
                    .crease = blossom.crease,
                    .root_color = tinted(blossom.inner_color, light),
                    .middle_color = tinted(blossom.outer_color, light * 0.96),
                    .tip_color = tinted(blossom.outer_color, light)};
        draw_blade(canvas, petal);
    }
    if (blossom.middle > 0)
        draw_dome(canvas, {.x = x,
                           .y = y,
                           .half_length = blossom.middle,
                           .half_width = blossom.middle,
                           .height = blossom.middle * 0.9,
                           .base = blossom.base + blossom.cup * 0.6,
                           .color = blossom.middle_color,
                           .second_color = tinted(blossom.middle_color, 0.55, 0.1),
                           .mottling = 0.8,
                           .salt = static_cast<std::uint32_t>(dice.bits())});
}

Thing flower(Dice& dice, const Blossom& blossom) {
    const std::uint64_t key = dice.bits();
    const double r = blossom.radius * 1.2 + 0.6;
    return {{-r, -r, r, r},
            [=](Canvas& canvas, double x, double y) { draw_blossom(canvas, x, y, blossom, Dice{key}); }};
}

}  // namespace

Thing make_grass(Dice& dice, double tone, double longer) {
    Blade blade;
    // Most lean with the wind a little, so that no direction is empty
    Direction d = any_direction(dice);
    d.x += 0.25;
    d.y += 0.35;
    const double norm = std::sqrt(d.x * d.x + d.y * d.y);
    blade.along = {d.x / norm, d.y / norm};
    blade.length = dice.uniform(6.0, 13.0) * longer * (0.55 + 0.45 * norm);
    blade.half_width = dice.uniform(0.75, 1.35);
    blade.bend = dice.uniform(-0.28, 0.28) * blade.length;
    blade.widest = 0.25;
    blade.base = dice.uniform(-0.5, 1.5);
    blade.lift = dice.uniform(1.6, 3.4);
    blade.sag = dice.uniform(0.0, 0.9);
    blade.crease = 0.7;
    blade.line = dice.uniform(0.1, 0.45);
    const double dry = dice.chance(0.06) ? 0.8 : dice.uniform(0.0, 0.25);
    const double light = dice.uniform(0.82, 1.2) * (1 + 0.42 * tone),
                 warm = 0.22 * tone + dice.uniform(-0.10, 0.14);
    const LinearColor straw{0.46, 0.40, 0.16};
    blade.root_color = tinted({0.050, 0.120, 0.022}, light, warm);
    blade.middle_color = tinted(blend({0.120, 0.250, 0.034}, straw, 0.5 * dry), light, warm);
    blade.tip_color = tinted(blend({0.215, 0.365, 0.060}, straw, dry), light, warm);
    Box reach = box_of(blade);
    return {reach, [blade](Canvas& canvas, double x, double y) {
                Blade here = blade;
                here.x = x;
                here.y = y;
                draw_blade(canvas, here);
            }};
}

Thing make_clover(Dice& dice) {
    const std::uint64_t key = dice.bits();
    const double r = dice.uniform(2.1, 3.2);
    return {{-2 * r, -2 * r, 2 * r, 2 * r}, [=](Canvas& canvas, double x, double y) {
                Dice own{key};
                const Direction start = any_direction(own);
                const double base = own.uniform(2.5, 4.8), light = own.uniform(0.8, 1.2);
                for (int i = 0; i < 3; ++i) {
                    const Direction d = turned(start, i / 3.0);
                    const double cx = x + d.x * r * 0.95, cy = y + d.y * r * 0.95;
                    canvas.draw({cx - r * 1.1, cy - r * 1.1, cx + r * 1.1, cy + r * 1.1},
                                [&](double px, double py, Paint& paint) {
                                    const double u = ((px - x) * d.x + (py - y) * d.y) / r;
                                    const double v = ((py - y) * d.x - (px - x) * d.y) / r;
                                    const double du = (u - 0.98) / 0.92, dv = v / 0.86;
                                    const double square = du * du + dv * dv;
                                    const double notch = u - 1.62 + 0.9 * std::abs(v) * -1.0;
                                    if (square >= 1 || notch > 0.0) return false;
                                    paint.height = base + 0.9 * u * 0.4 + 0.7 * std::abs(v) + 0.04 * i;
                                    // The pale arc across each leaflet
                                    const double arc = u * u * 0.9 + v * v - 0.75;
                                    const double pale = smooth_step(0.24, 0.06, std::abs(arc));
                                    const double vein = smooth_step(0.10, 0.02, std::abs(v)) * 0.3;
                                    paint.color = tinted(
                                        blend({0.060, 0.190, 0.040}, {0.20, 0.36, 0.14}, 0.75 * pale + vein),
                                        light * (0.8 + 0.25 * u));
                                    return true;
                                });
                }
            }};
}

Thing make_daisy(Dice& dice) {
    return flower(dice, {.petals = 11,
                         .radius = dice.uniform(3.8, 5.0),
                         .petal_width = 0.85,
                         .base = dice.uniform(5.0, 6.5),
                         .cup = 0.5,
                         .blunt = 0.8,
                         .inner_color = {0.62, 0.64, 0.50},
                         .outer_color = {0.86, 0.86, 0.82},
                         .middle_color = {0.80, 0.50, 0.03},
                         .middle = 1.5});
}

Thing make_buttercup(Dice& dice) {
    return flower(dice, {.petals = 5,
                         .radius = dice.uniform(2.9, 3.8),
                         .petal_width = 1.75,
                         .base = dice.uniform(5.0, 7.0),
                         .cup = 1.0,
                         .inner_color = {0.55, 0.33, 0.01},
                         .outer_color = {0.90, 0.62, 0.02},
                         .middle_color = {0.55, 0.42, 0.03},
                         .middle = 0.85});
}

Thing make_bellflower(Dice& dice) {
    const double hue = dice.uniform(0, 1);
    return flower(dice, {.petals = 5,
                         .radius = dice.uniform(3.3, 4.4),
                         .petal_width = 1.5,
                         .base = dice.uniform(5.0, 7.0),
                         .cup = 1.3,
                         .blunt = 0.25,
                         .widest = 0.5,
                         .inner_color = {0.42, 0.36, 0.70},
                         .outer_color = blend({0.16, 0.10, 0.56}, {0.34, 0.12, 0.52}, hue),
                         .middle_color = {0.75, 0.70, 0.42},
                         .middle = 0.8});
}

Thing make_poppy(Dice& dice) {
    return flower(dice, {.petals = 4,
                         .radius = dice.uniform(5.0, 6.5),
                         .petal_width = 3.9,
                         .base = dice.uniform(5.5, 7.0),
                         .cup = 1.6,
                         .widest = 0.62,
                         .inner_color = {0.10, 0.012, 0.01},
                         .outer_color = {0.76, 0.055, 0.020},
                         .middle_color = {0.05, 0.055, 0.035},
                         .middle = 1.4,
                         .crease = -0.35});
}

Thing make_dandelion(Dice& dice) {
    return flower(dice, {.petals = 19,
                         .radius = dice.uniform(3.6, 4.6),
                         .petal_width = 0.7,
                         .base = dice.uniform(4.5, 6.0),
                         .cup = 0.9,
                         .blunt = 0.6,
                         .inner_color = {0.75, 0.42, 0.01},
                         .outer_color = {0.88, 0.60, 0.015},
                         .middle_color = {0.72, 0.40, 0.01},
                         .middle = 1.6});
}

Thing make_mushroom(Dice& dice, bool red) {
    const double r = red ? dice.uniform(4.6, 7.0) : dice.uniform(2.4, 4.2);
    const std::uint64_t key = dice.bits();
    return {{-r - 0.4, -r - 0.4, r + 0.4, r + 2.0}, [=](Canvas& canvas, double x, double y) {
                Dice own{key};
                const double base = own.uniform(2.5, 4.5);
                // The stalk shows below the cap, since one looks at a meadow a little from the front
                draw_blade(canvas, {.x = x,
                                    .y = y,
                                    .along = {0.12, 0.9928},
                                    .length = r + 1.6,
                                    .half_width = r * 0.34,
                                    .widest = 0.8,
                                    .blunt = 1,
                                    .base = base,
                                    .lift = 0,
                                    .crease = 1.0,
                                    .root_color = {0.55, 0.50, 0.40},
                                    .middle_color = {0.62, 0.56, 0.45},
                                    .tip_color = {0.42, 0.37, 0.28}});
                const LinearColor cap = red ? tinted({0.62, 0.035, 0.016}, own.uniform(0.85, 1.1))
                                            : tinted({0.36, 0.20, 0.085}, own.uniform(0.8, 1.25), 0.06);
                const double h = r * 0.72;
                std::array<std::array<double, 3>, 9> spots{};
                for (auto& spot : spots) {
                    const Direction d = any_direction(own);
                    const double far = own.uniform(0.05, 0.85);
                    spot = {d.x * far, d.y * far, own.uniform(0.09, 0.2) * (1.1 - 0.5 * far)};
                }
                canvas.draw({x - r, y - r, x + r, y + r}, [&](double px, double py, Paint& paint) {
                    const double u = (px - x) / r, v = (py - y) / (r * 0.93);
                    const double square = u * u + v * v;
                    if (square >= 1) return false;
                    const double up = std::sqrt(1 - square);
                    paint.height = base + 1.2 + h * up;
                    paint.color = tinted(cap, 0.75 + 0.35 * up);
                    if (!red) {
                        paint.color = blend(tinted(cap, 1.25), tinted(cap, 0.7), square);
                    } else {
                        for (const auto& spot : spots) {
                            const double du = u - spot[0], dv = v - spot[1];
                            if (du * du + dv * dv < spot[2] * spot[2]) {
                                paint.color = {0.80, 0.76, 0.66};
                                paint.height += 0.25;
                                break;
                            }
                        }
                    }
                    return true;
                });
            }};
}

Thing make_stone(Dice& dice, double radius, double moss) {
    Dome dome;
    dome.along = any_direction(dice);
    dome.half_length = radius * dice.uniform(1.0, 1.35);
    dome.half_width = radius * dice.uniform(0.75, 1.0);
    dome.height = radius * dice.uniform(0.55, 0.8);
    dome.base = 1.2;
    dome.rough = 0.9;
    dome.flat = dice.uniform(0.1, 0.6);
    const double warm = dice.uniform(-0.05, 0.12), light = dice.uniform(0.75, 1.25);
    dome.color = tinted({0.26, 0.25, 0.235}, light, warm);
    dome.second_color = moss > 0 ? LinearColor{0.10, 0.16, 0.035} : tinted({0.38, 0.36, 0.33}, light, warm);
    dome.mottling = moss > 0 ? moss : 0.7;
    dome.salt = static_cast<std::uint32_t>(dice.bits());
    return {box_of(dome), [dome](Canvas& canvas, double x, double y) {
                Dome here = dome;
                here.x = x;
                here.y = y;
                draw_dome(canvas, here);
            }};
}

Thing make_fallen_leaf(Dice& dice) {
    const double warm = dice.uniform(0, 1), light = dice.uniform(0.8, 1.15);
    const LinearColor color = tinted(blend({0.46, 0.17, 0.03}, {0.52, 0.33, 0.05}, warm), light);
    Blade blade{.along = any_direction(dice),
                .length = dice.uniform(8.0, 11.0),
                .half_width = dice.uniform(2.4, 3.4),
                .bend = dice.uniform(-1, 1),
                .widest = 0.45,
                .blunt = 0.2,
                .base = dice.uniform(4.5, 6.0),
                .lift = 0.8,
                .sag = 0.5,
                .crease = -0.5,
                .root_color = tinted(color, 0.8),
                .middle_color = color,
                .tip_color = tinted(color, 0.75),
                .line = 0.5};
    return {box_of(blade), [blade](Canvas& canvas, double x, double y) {
                Blade here = blade;
                here.x = x;
                here.y = y;
                draw_blade(canvas, here);
            }};
}

void draw_soil(Canvas& tile, std::uint32_t border_salt, std::uint32_t own_salt) {
    const double side = tile.side();
    tile.fill([&](double x, double y, Paint& paint) {
        const double lump = tile_noise(x, y, side, 8, border_salt, own_salt, 4);
        paint.height = -1.5 + 1.2 * lump;
        paint.color = tinted(blend({0.045, 0.034, 0.018}, {0.050, 0.075, 0.018}, 0.5 + 0.5 * lump), 1.0);
    });
}

void plant_meadow(Canvas& tile, std::int32_t number, std::uint64_t border_key, std::uint64_t own_key,
                  const std::function<bool(double, double)>& may_be) {
    const double side = tile.side(), area = side * side / 4096.0;
    const auto salt = static_cast<std::uint32_t>(own_key);
    // Grass: lighter and darker tufts, the same along every border
    const double rich = number % 3 == 1 ? 1.08 : 1.0;
    scatter(tile, {.border_key = border_key,
                   .own_key = own_key,
                   .count = 560 * area,
                   .make =
                       [&, salt](Dice& dice, double x, double y) {
                           const double mine = inner(x, y, side, side * 0.35);
                           const double tuft = mine * (noise(x * 0.045, y * 0.045, salt) * 1.1 +
                                                       0.35 * noise(x * 0.13, y * 0.13, salt + 1));
                           return make_grass(dice, tuft, mix_linear(1.0, rich, mine));
                       },
                   .may_be = may_be});
    struct Plot {
        std::function<Thing(Dice&)> make;
        double count;
        double clump;  ///< Texels: things lie this close round one place; 0: everywhere.
    };
    const auto any = [](auto make) { return [make](Dice& dice) { return make(dice); }; };
    std::vector<Plot> plots;
    switch (number) {
        case 1:
            plots = {{any(make_clover), 46, 30}};
            break;
        case 2:
            plots = {{any(make_daisy), 8, 30}};
            break;
        case 3:
            plots = {{any(make_buttercup), 9, 28}};
            break;
        case 4:
            plots = {{[](Dice& d) { return make_stone(d, d.uniform(7.0, 8.5), 0.55); }, 1, 8},
                     {[](Dice& d) { return make_stone(d, d.uniform(1.8, 3.6), 0.25); }, 6, 26}};
            break;
        case 5:
            plots = {{[](Dice& d) { return make_mushroom(d, true); }, 3, 17}, {any(make_clover), 8, 26}};
            break;
        case 6:
            plots = {{any(make_bellflower), 9, 27}};
            break;
        case 7:
            plots = {{any(make_clover), 26, 30}, {any(make_daisy), 3, 26}};
            break;
        case 8:
            plots = {{[](Dice& d) { return make_mushroom(d, false); }, 7, 15}};
            break;
        case 9:
            plots = {{any(make_poppy), 4, 26}};
            break;
        case 10:
            plots = {{any(make_fallen_leaf), 5, 28}};
            break;
        case 11:
            plots = {{any(make_dandelion), 4, 26}, {any(make_clover), 14, 28}};
            break;
        case 12:
            plots = {{[](Dice& d) { return make_stone(d, d.uniform(1.6, 3.6), 0.3); }, 8, 28},
                     {any(make_buttercup), 3, 28}};
            break;
        case 13:
            plots = {{any(make_daisy), 2, 28}, {any(make_bellflower), 3, 28}};
            break;
        default:
            break;
    }
    std::uint64_t plot_number = 0;
    for (const Plot& plot : plots) {
        Dice dice{hash(own_key, stream("plot"), static_cast<std::int64_t>(plot_number++), 0)};
        const double cx = dice.uniform(0.4, 0.6) * side, cy = dice.uniform(0.4, 0.6) * side;
        for (int i = 0; i < plot.count; ++i)
            for (int tries = 0; tries < 20; ++tries) {
                const Direction d = any_direction(dice);
                const double far = std::sqrt(dice.uniform(0, 1)) * plot.clump;
                const double x = cx + d.x * far, y = cy + d.y * far;
                const Thing thing = plot.make(dice);
                const double keep = 1.5;
                if (x + thing.reach.left < keep || y + thing.reach.top < keep ||
                    x + thing.reach.right > side - keep || y + thing.reach.bottom > side - keep)
                    continue;
                if (may_be && !may_be(x, y)) continue;
                thing.paint(tile, x, y);
                break;
            }
    }
}

Rgba8Image paint_meadow_tile(std::int32_t number, std::int32_t side) {
    Canvas tile{side, 3};
    const std::uint64_t own = hash(1, stream("meadow"), number, 0);
    draw_soil(tile, 11, static_cast<std::uint32_t>(own >> 7));
    plant_meadow(tile, number, stream("meadow border"), own, nullptr);
    return tile.develop({.sun = 1.05, .sky = 0.9, .shade = 0.8, .glow = 0.22, .level = 1.0});
}

}  // namespace tessera::painting
