#include "server/scenes/patterns/shore.h"

#include <cmath>

#include "server/scenes/patterns/meadow.h"
#include "server/scenes/patterns/scatter.h"
#include "server/scenes/patterns/shapes.h"
#include "shared/math/hash.h"

namespace tessera::painting {
namespace {

constexpr std::int32_t sand = 1;

/// Distance to the border between the families, in parts of a tile: above 0 on sand.
struct Shore {
    Corners corners;
    double side;
    std::uint32_t salt;

    double operator()(double x, double y) const noexcept {
        const double share = corner_share(corners, sand, x, y, side);
        return share - 0.5 + 0.38 * tile_noise(x, y, side, 4, 901, salt, 3);
    }
};

void draw_sand(Canvas& tile, std::uint32_t salt, const Shore* shore) {
    const double side = tile.side();
    tile.fill([&](double x, double y, Paint& paint) {
        // Ripples across the wind, bent by slow noise
        const double bend = tile_noise(x, y, side, 2, 401, salt, 2);
        const double wave = tile_noise(x + 3 * bend, y, side, 3, 402, salt + 1, 2);
        const double phase = y / side * 8 + 0.9 * bend + 0.5 * wave;
        const double t = phase - static_cast<double>(whole_below(phase));
        const double ridge = t < 0.62 ? smooth_step(0.0, 0.62, t) : smooth_step(1.0, 0.62, t);
        const double grain = noise(x * 1.9, y * 1.9, salt + 5) * inner(x, y, side, 3);
        const double lump = tile_noise(x, y, side, 4, 403, salt + 2, 3);
        paint.height = -0.6 + 0.75 * ridge * (0.55 + 0.45 * wave) + 0.9 * lump + 0.10 * grain;
        const double light = 1.0 + 0.12 * grain + 0.10 * lump - 0.06 * (1 - ridge);
        paint.color = tinted(blend({0.42, 0.315, 0.175}, {0.56, 0.445, 0.27}, 0.5 + 0.5 * lump), light);
        if (shore != nullptr) {
            // Damp and full of humus where the meadow is near; below the meadow, soil
            const double far = (*shore)(x, y);
            const double soil = smooth_step(0.10, -0.06, far);
            paint.color = blend(paint.color, tinted({0.085, 0.058, 0.030}, 1 + 0.4 * grain), 0.92 * soil);
            paint.height += 0.9 * smooth_step(0.06, -0.10, far) - 0.5 * smooth_step(0.16, 0.02, far);
        }
    });
}

Thing make_shell(Dice& dice) {
    const std::uint64_t key = dice.bits();
    const double r = dice.uniform(2.6, 4.4);
    return {{-r, -r, r, r}, [=](Canvas& canvas, double x, double y) {
                Dice own{key};
                const Direction d = any_direction(own);
                const double warm = own.uniform(0, 1);
                const LinearColor light = blend({0.86, 0.78, 0.68}, {0.82, 0.56, 0.46}, warm);
                const LinearColor dark = blend({0.60, 0.46, 0.34}, {0.58, 0.28, 0.22}, warm);
                canvas.draw({x - r, y - r, x + r, y + r}, [&](double px, double py, Paint& paint) {
                    const double dx = px - x, dy = py - y;
                    // A fan about its hinge
                    const double u = (dx * d.x + dy * d.y) / r + 0.75, v = (dy * d.x - dx * d.y) / r;
                    const double far = std::sqrt(u * u + v * v);
                    if (u <= 0.02 || far > 1.55 - 0.1 * std::abs(v) || std::abs(v) > 0.95 * u + 0.12)
                        return false;
                    const double ray = v / (u + 0.25) * 5.5;
                    const double t = ray - static_cast<double>(whole_below(ray));
                    const double rib = 4 * t * (1 - t);
                    const double ring = far * 4.2 - static_cast<double>(whole_below(far * 4.2));
                    paint.height =
                        0.8 + r * 0.35 * (1 - (far - 0.8) * (far - 0.8)) - 0.5 * v * v + 0.22 * rib;
                    paint.color = blend(dark, light, 0.35 + 0.45 * rib + 0.25 * ring);
                    return true;
                });
            }};
}

Thing make_starfish(Dice& dice) {
    const std::uint64_t key = dice.bits();
    const double r = dice.uniform(7.0, 9.0);
    return {{-r - 1, -r - 1, r + 1, r + 1}, [=](Canvas& canvas, double x, double y) {
                Dice own{key};
                const Direction start = any_direction(own);
                for (int i = 0; i < 5; ++i)
                    draw_blade(canvas, {.x = x,
                                        .y = y,
                                        .along = turned(start, (i + own.uniform(-0.15, 0.15)) / 5.0),
                                        .length = r * own.uniform(0.9, 1.05),
                                        .half_width = r * 0.26,
                                        .bend = own.uniform(-1.2, 1.2),
                                        .widest = 0.18,
                                        .blunt = 0.15,
                                        .base = 0.9,
                                        .lift = 0.3,
                                        .sag = 1.2,
                                        .crease = 0.8,
                                        .root_color = {0.66, 0.24, 0.08},
                                        .middle_color = {0.70, 0.29, 0.10},
                                        .tip_color = {0.60, 0.20, 0.07},
                                        .line = 0.35});
            }};
}

Thing make_driftwood(Dice& dice) {
    Blade blade{.along = any_direction(dice),
                .length = dice.uniform(16, 26),
                .half_width = dice.uniform(1.3, 2.0),
                .bend = dice.uniform(-3, 3),
                .widest = 0.35,
                .blunt = 0.6,
                .base = 0.7,
                .lift = 0.6,
                .sag = 0.8,
                .crease = 1.1,
                .root_color = {0.30, 0.24, 0.18},
                .middle_color = {0.38, 0.32, 0.25},
                .tip_color = {0.26, 0.20, 0.15},
                .line = 0.25};
    return {box_of(blade), [blade](Canvas& canvas, double x, double y) {
                Blade here = blade;
                here.x = x;
                here.y = y;
                draw_blade(canvas, here);
            }};
}

/// A tuft of dune grass.
Thing make_tuft(Dice& dice) {
    const std::uint64_t key = dice.bits();
    return {{-13, -13, 13, 13}, [=](Canvas& canvas, double x, double y) {
                Dice own{key};
                const int blades = 14 + static_cast<int>(own.uniform(0, 10));
                for (int i = 0; i < blades; ++i) {
                    const double light = own.uniform(0.75, 1.25);
                    const Direction d = any_direction(own);
                    draw_blade(canvas, {.x = x + own.uniform(-1.6, 1.6),
                                        .y = y + own.uniform(-1.6, 1.6),
                                        .along = d,
                                        .length = own.uniform(5, 11),
                                        .half_width = own.uniform(0.55, 0.9),
                                        .bend = own.uniform(-3, 3),
                                        .widest = 0.2,
                                        .base = own.uniform(0.5, 2.0),
                                        .lift = own.uniform(2.0, 4.0),
                                        .sag = own.uniform(0.4, 1.2),
                                        .crease = 0.7,
                                        .root_color = tinted({0.10, 0.13, 0.03}, light),
                                        .middle_color = tinted({0.22, 0.29, 0.07}, light),
                                        .tip_color = tinted({0.46, 0.44, 0.17}, light),
                                        .line = 0.3});
                }
            }};
}

void lie_on_sand(Canvas& tile, std::int32_t variant, std::uint64_t own_key,
                 const std::function<bool(double, double)>& may_be) {
    const auto pebble = [](Dice& d) {
        const double r = d.uniform(0.5, 1.0);
        Thing stone = make_stone(d, r * (1 + d.uniform(0, 1.3) * d.uniform(0, 1)), 0);
        return stone;
    };
    // Small stones lie on every border, at the same places; the rest is each tile's own
    scatter(tile, {.border_key = stream("grit"),
                   .own_key = own_key,
                   .count = 13,
                   .make = [&](Dice& dice, double, double) { return pebble(dice); },
                   .may_be = may_be});
    const auto only_inside = [&](const char* name, int count, const std::function<Thing(Dice&)>& make) {
        Dice dice{hash(own_key, stream(name), 1, 0)};
        for (int i = 0; i < count; ++i)
            for (int tries = 0; tries < 30; ++tries) {
                const double x = dice.uniform(4, tile.side() - 4.0), y = dice.uniform(4, tile.side() - 4.0);
                const Thing thing = make(dice);
                if (x + thing.reach.left < 1 || y + thing.reach.top < 1 ||
                    x + thing.reach.right > tile.side() - 1.0 || y + thing.reach.bottom > tile.side() - 1.0 ||
                    (may_be && !may_be(x, y)))
                    continue;
                thing.paint(tile, x, y);
                break;
            }
    };
    switch (variant) {
        case 2:
            only_inside("shell", 3, make_shell);
            break;
        case 3:
            only_inside("stones", 9, [](Dice& d) { return make_stone(d, d.uniform(1.4, 3.4), 0); });
            break;
        case 5:
            only_inside("starfish", 1, make_starfish);
            break;
        case 6:
            only_inside("wood", 2, make_driftwood);
            break;
        case 8:
            only_inside("tuft", 2, make_tuft);
            break;
        case 9:
            only_inside("boulder", 2, [](Dice& d) { return make_stone(d, d.uniform(5.0, 7.5), 0); });
            only_inside("stones", 6, [](Dice& d) { return make_stone(d, d.uniform(1.2, 2.4), 0); });
            break;
        case 11:
            only_inside("shell", 1, make_shell);
            only_inside("tuft", 1, make_tuft);
            break;
        case 13:
            only_inside("stones", 14, [](Dice& d) { return make_stone(d, d.uniform(0.9, 2.0), 0); });
            break;
        default:
            break;
    }
}

}  // namespace

double corner_share(const Corners& corners, std::int32_t family, double x, double y, double side) noexcept {
    const auto is = [&](std::size_t corner) { return corners[corner] == family ? 1.0 : 0.0; };
    const double u = x / side, v = y / side;
    return mix_linear(mix_linear(is(0), is(1), u), mix_linear(is(2), is(3), u), v);
}

Rgba8Image paint_shore_tile(const Corners& corners, std::int32_t variant, std::int32_t side) {
    Canvas tile{side, 3};
    const std::int32_t which = corners[0] + 2 * corners[1] + 4 * corners[2] + 8 * corners[3];
    const std::uint64_t own = hash(2, stream("shore"), which, variant);
    const auto salt = static_cast<std::uint32_t>(own >> 7);
    const Shore shore{corners, double(side), salt};
    const bool has_sand = which != 0, has_meadow = which != 15;
    if (has_sand) {
        draw_sand(tile, salt, has_meadow ? &shore : nullptr);
        lie_on_sand(tile, has_meadow ? 0 : variant, own,
                    has_meadow ? std::function<bool(double, double)>{[&](double x, double y) {
                        return shore(x, y) > 0.08;
                    }}
                               : nullptr);
    } else {
        draw_soil(tile, 11, salt);
    }
    if (has_meadow)
        plant_meadow(tile, has_sand ? 0 : variant, stream("meadow border"), own,
                     has_sand ? std::function<bool(double, double)>{[&](double x, double y) {
                         return shore(x, y) < 0;
                     }}
                              : nullptr);
    return tile.develop({.sun = 1.05, .sky = 0.9, .shade = 0.8, .glow = 0.22, .level = 1.0});
}

}  // namespace tessera::painting
