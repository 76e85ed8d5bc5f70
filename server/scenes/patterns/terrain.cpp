#include "server/scenes/patterns/terrain.h"

#include <cmath>

#include "server/scenes/patterns/scatter.h"
#include "server/scenes/patterns/shapes.h"
#include "shared/math/hash.h"

namespace tessera::painting {
namespace {

constexpr std::int32_t sand = 0, forest = 1, rock = 2, snow = 3;

/// Parabolas up and down, −1 to 1, one unit long.
double ridge_of(double n) noexcept { return 1 - 2 * std::abs(n); }

/// Which family is on top, and by how much it is ahead of the next.
struct Lead {
    std::int32_t family = 0, second = 0;
    double ahead = 1;
};

struct Land {
    Corners corners;
    double side;
    std::uint32_t salt;

    Lead operator()(double x, double y) const noexcept {
        double shares[land_families], most = 0;
        for (std::int32_t family = 0; family < land_families; ++family) {
            shares[family] = corner_share(corners, family, x, y, side);
            most = std::max(most, shares[family]);
        }
        Lead lead;
        double best = -9, next = -9;
        for (std::int32_t family = 0; family < land_families; ++family) {
            double share = shares[family];
            if (share <= 0 || share < most - 0.45) continue;  // no noise would bring it to the top
            if (most < 0.95) {
                const auto border = 700u + 10u * static_cast<std::uint32_t>(family);
                share += 0.20 * tile_noise(x, y, side, 5, border, salt + border, 2);
            }
            if (share > best) {
                next = best;
                lead.second = lead.family;
                best = share;
                lead.family = family;
            } else if (share > next) {
                next = share;
                lead.second = family;
            }
        }
        lead.ahead = next > -9 ? best - next : 1;
        return lead;
    }
};

/// Height and colour of open ground of one family.
void ground(std::int32_t family, double x, double y, double side, std::uint32_t salt, Paint& paint) {
    switch (family) {
        case sand: {
            const double bend = tile_noise(x, y, side, 2, 801, salt, 3);
            const double phase = (y / side) * 5 + (x / side) * 2 + 1.1 * bend;
            const double t = phase - static_cast<double>(whole_below(phase));
            const double dune = t < 0.68 ? smooth_step(0.0, 0.68, t) : smooth_step(1.0, 0.68, t);
            const double grain = noise(x * 0.9, y * 0.9, salt + 1) * inner(x, y, side, 3);
            paint.height = 2.1 * dune * (0.7 + 0.5 * bend) + 0.15 * grain;
            paint.color =
                tinted(blend({0.50, 0.345, 0.17}, {0.66, 0.50, 0.285}, 0.35 + 0.4 * dune + 0.4 * bend),
                       1 + 0.07 * grain);
            break;
        }
        case forest: {
            const double lump = tile_noise(x, y, side, 6, 811, salt, 3);
            paint.height = 0.8 * lump;
            paint.color = blend({0.030, 0.052, 0.014}, {0.10, 0.14, 0.03}, 0.5 + 0.5 * lump);
            break;
        }
        case rock: {
            const double n1 = tile_noise(x, y, side, 3, 821, salt, 2),
                         n2 = tile_noise(x, y, side, 6, 822, salt + 1, 3);
            const double crag = ridge_of(n1 * 1.3), fine = ridge_of(n2 * 1.4);
            paint.height = 5.5 * crag + 2.6 * fine + 1.0;
            const double band = noise(x * 0.05 + crag * 2.0, y * 0.22, 77) * 0.5;
            paint.color =
                tinted(blend({0.115, 0.100, 0.090}, {0.30, 0.275, 0.25}, 0.5 + 0.3 * crag + 0.35 * fine), 1,
                       0.06 + 0.10 * band * inner(x, y, side, 8));
            break;
        }
        default: {
            const double drift = tile_noise(x, y, side, 2, 831, salt, 3),
                         soft = tile_noise(x, y, side, 5, 832, salt + 1, 2);
            paint.height = 4.2 * ridge_of(drift) + 1.0 * soft + 2.0;
            paint.color = blend({0.66, 0.735, 0.84}, {0.86, 0.89, 0.93}, 0.5 + 0.5 * ridge_of(drift));
            break;
        }
    }
}

/// The crown of a tree.
Thing make_crown(Dice& dice) {
    const bool is_fir = dice.chance(0.55);
    const double r = is_fir ? dice.uniform(2.2, 3.6) : dice.uniform(2.8, 4.8);
    const double light = dice.uniform(0.72, 1.3), warm = dice.uniform(-0.08, 0.22);
    const auto salt = static_cast<std::uint32_t>(dice.bits());
    const double base = dice.uniform(2.0, 5.0);
    const Direction start = any_direction(dice);
    return {{-r * 1.2, -r * 1.2, r * 1.2, r * 1.2}, [=](Canvas& canvas, double x, double y) {
                canvas.draw({x - r * 1.2, y - r * 1.2, x + r * 1.2, y + r * 1.2}, [&](double px, double py,
                                                                                      Paint& paint) {
                    const double dx = (px - x) / r, dy = (py - y) / r;
                    double square = dx * dx + dy * dy;
                    if (is_fir) {
                        // Rays of branches
                        const double c = dx * start.x + dy * start.y, s = dy * start.x - dx * start.y;
                        const double many =
                            (c * c * c * c + s * s * s * s - 6 * c * c * s * s) / (square * square + 1e-9);
                        const double rim = 0.86 + 0.14 * many;
                        if (square >= rim * rim) return false;
                        const double far = std::sqrt(square);
                        const double whorl = far * 3.2 - static_cast<double>(whole_below(far * 3.2));
                        paint.height = base + r * 1.9 * (1 - far) + 0.35 * (1 - whorl);
                        paint.color = tinted(blend({0.020, 0.052, 0.020}, {0.060, 0.125, 0.042},
                                                   0.75 - 0.5 * whorl + 0.25 * (1 - far)),
                                             light, 0.4 * warm);
                        return true;
                    }
                    square *= 1 + 0.35 * noise(dx * 1.6, dy * 1.6, salt);
                    if (square >= 1) return false;
                    const double tuft = noise(dx * 3.1, dy * 3.1, salt + 1);
                    paint.height = base + r * 0.9 * std::sqrt(1 - square) + 0.75 * tuft;
                    paint.color = tinted(
                        blend({0.048, 0.098, 0.016}, {0.135, 0.215, 0.036}, 0.5 + 0.6 * tuft), light, warm);
                    return true;
                });
            }};
}

Thing make_boulder(Dice& dice) {
    Dome dome;
    dome.along = any_direction(dice);
    const double r = dice.uniform(0.9, 2.4);
    dome.half_length = r * 1.25;
    dome.half_width = r;
    dome.height = r * 0.8;
    dome.rough = 1;
    dome.flat = 0.3;
    dome.color = tinted({0.20, 0.185, 0.17}, dice.uniform(0.7, 1.4), 0.06);
    dome.salt = static_cast<std::uint32_t>(dice.bits());
    return {box_of(dome), [dome](Canvas& canvas, double x, double y) {
                Dome here = dome;
                here.x = x;
                here.y = y;
                here.base = canvas.height(x, y) - 0.3 * dome.height;
                draw_dome(canvas, here);
            }};
}

}  // namespace

Rgba8Image paint_land_tile(const Corners& corners, std::int32_t variant, std::int32_t side) {
    Canvas tile{side, 2};
    const std::int32_t which = ((corners[0] * 4 + corners[1]) * 4 + corners[2]) * 4 + corners[3];
    const std::uint64_t own = hash(5, stream("land"), which, variant);
    const auto salt = static_cast<std::uint32_t>(own >> 7);
    const double size = side;
    const Land land{corners, size, salt};
    bool has[land_families] = {};
    for (const std::int32_t family : corners) has[family] = true;
    tile.fill([&](double x, double y, Paint& paint) {
        const Lead lead = land(x, y);
        ground(lead.family, x, y, size, salt, paint);
        if (lead.ahead < 0.16) {
            Paint other;
            ground(lead.second, x, y, size, salt, other);
            // What is higher up thins out over what is lower; snow keeps a sharp rim
            const double soft = lead.family == snow || lead.second == snow ? 0.05 : 0.13;
            const double t = 0.5 * smooth_step(soft, 0.0, lead.ahead);
            const double thin = lead.family > lead.second ? 0.9 * smooth_step(0.16, 0.0, lead.ahead) : 0.0;
            paint.color = blend(paint.color, other.color, t);
            paint.height = mix_linear(paint.height, other.height, std::max(t, 0.5 * thin));
        }
    });
    if (has[rock] || has[sand])
        scatter(tile, {.border_key = stream("boulders"),
                       .own_key = hash(own, stream("boulders"), 0, 0),
                       .count = 22,
                       .make = [](Dice& dice, double, double) { return make_boulder(dice); },
                       .may_be =
                           [&](double x, double y) {
                               const Lead lead = land(x, y);
                               return lead.family == rock ||
                                      (lead.family == sand && lead.second == rock && lead.ahead < 0.5);
                           }});
    if (has[forest])
        scatter(tile, {.border_key = stream("crowns"),
                       .own_key = hash(own, stream("crowns"), 0, 0),
                       .count = 330,
                       .make = [](Dice& dice, double, double) { return make_crown(dice); },
                       .may_be = [&](double x, double y) { return land(x, y).family == forest; }});
    return tile.develop({.sun = 1.08, .sky = 0.95, .shade = 0.35, .glow = 0.06, .level = 0.96});
}

std::vector<std::uint8_t> paint_land_map(std::int32_t side) {
    std::vector<std::uint8_t> map(std::size_t(side) * std::size_t(side));
    const auto row = [&](std::int32_t j) {
        for (std::int32_t i = 0; i < side; ++i) {
            const double u = (i + 0.5) / side, v = (j + 0.5) / side;
            // Bent coordinates: coasts and ranges that wind
            const double bu = u + 0.035 * fractal_noise(u * 4, v * 4, 1001, 3, 4),
                         bv = v + 0.035 * fractal_noise(u * 4, v * 4, 1002, 3, 4);
            const double continent = fractal_noise(bu * 3, bv * 3, 1003, 8, 3);
            const double n = fractal_noise(bu * 6, bv * 6, 1004, 6, 6);
            const double range = (1 - 2.2 * std::abs(n)) * smooth_step(-0.05, 0.40, continent + 0.10);
            const double crags = fractal_noise(bu * 40, bv * 40, 1006, 4, 40);
            const double height = continent + 0.55 * range + 0.13 * crags;
            const double moist = fractal_noise(bu * 5, bv * 5, 1005, 7, 5);
            std::uint8_t family = sand;
            if (height > 0.08 + (-0.30) * moist && height > -0.02) family = forest;
            if (height > 0.46 + 0.06 * moist) family = rock;
            if (height > 0.86 - 0.30 * (0.5 - std::abs(v - 0.5))) family = snow;
            map[std::size_t(j) * std::size_t(side) + std::size_t(i)] = family;
        }
    };
    std::vector<std::jthread> painters;
    const auto hands = std::clamp(static_cast<std::int32_t>(std::thread::hardware_concurrency()), 1, 16);
    for (std::int32_t hand = 0; hand < hands; ++hand)
        painters.emplace_back([&, hand] {
            for (std::int32_t j = hand; j < side; j += hands) row(j);
        });
    painters.clear();
    return map;
}

}  // namespace tessera::painting
