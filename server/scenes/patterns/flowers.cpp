#include "server/scenes/patterns/flowers.h"

#include <array>

#include "server/scenes/patterns/leaf.h"
#include "server/scenes/patterns/shapes.h"
#include "shared/math/hash.h"

namespace tessera::painting {
namespace {

struct FlowerKind {
    std::int32_t petals;
    double half_width, blunt;  ///< Of an open petal, as a part of the side.
    LinearColor heart, middle, tip, eye;
};

const std::array<FlowerKind, flower_kinds> kinds{{
    {12, 0.055, 0.6, {0.70, 0.66, 0.30}, {0.88, 0.88, 0.86}, {0.92, 0.92, 0.94}, {0.80, 0.46, 0.02}},
    {7, 0.095, 1.0, {0.30, 0.03, 0.10}, {0.74, 0.10, 0.24}, {0.86, 0.26, 0.38}, {0.16, 0.06, 0.02}},
    {9, 0.075, 0.3, {0.60, 0.20, 0.00}, {0.90, 0.48, 0.01}, {0.95, 0.68, 0.06}, {0.22, 0.10, 0.02}},
}};

}  // namespace

Rgba8Image paint_flower(std::int32_t kind, double open, std::int32_t side) {
    const FlowerKind& is = kinds[static_cast<std::size_t>(kind)];
    Canvas canvas{side, 4};
    Dice dice{hash(17, stream("flower"), kind, 0)};
    const double middle = 0.5 * side;
    // Leaves that do not move, a bud's sepals, then its petals
    const Direction start = any_direction(dice);
    for (int i = 0; i < 5; ++i) {
        const Direction d = turned(start, (i + dice.uniform(-0.2, 0.2)) / 5.0);
        draw_blade(canvas, {.x = middle + d.x,
                            .y = middle + d.y,
                            .along = d,
                            .length = side * dice.uniform(0.24, 0.34),
                            .half_width = side * 0.035,
                            .bend = side * dice.uniform(-0.03, 0.03),
                            .widest = 0.4,
                            .base = 0.5,
                            .lift = 1.5,
                            .sag = 1,
                            .crease = -0.3,
                            .root_color = {0.05, 0.13, 0.02},
                            .middle_color = {0.09, 0.21, 0.03},
                            .tip_color = {0.14, 0.27, 0.05},
                            .line = 0.3});
    }
    const double length = side * mix_linear(0.13, 0.44, open);
    const double half_width = side * mix_linear(0.04, is.half_width, open);
    for (std::int32_t ring = 0; ring < 2; ++ring)
        for (std::int32_t i = 0; i < is.petals; ++i) {
            const Direction d = turned(start, (i + 0.5 * ring + dice.uniform(-0.12, 0.12)) / is.petals);
            const double light = dice.uniform(0.88, 1.05);
            const double shorter = ring == 0 ? 1.0 : mix_linear(0.9, 0.72, open);
            // Petals of a bud stand upright, of green backs
            const LinearColor green{0.12, 0.22, 0.05};
            draw_blade(canvas, {.x = middle + d.x * side * 0.02,
                                .y = middle + d.y * side * 0.02,
                                .along = d,
                                .length = length * shorter,
                                .half_width = half_width,
                                .bend = 0,
                                .widest = mix_linear(0.5, 0.68, open),
                                .blunt = is.blunt,
                                .base = 3 + 1.2 * ring + 0.05 * i,
                                .lift = mix_linear(9, 2.5, open),
                                .sag = mix_linear(0, 0.8, open),
                                .crease = -0.25,
                                .root_color = tinted(blend(green, is.heart, open), light),
                                .middle_color = tinted(blend(green, is.middle, 0.25 + 0.75 * open), light),
                                .tip_color = tinted(blend(is.middle, is.tip, open), light)});
        }
    const double eye = side * mix_linear(0.0, 0.085, open);
    if (eye > 0.5)
        draw_dome(canvas, {.x = middle,
                           .y = middle,
                           .half_length = eye,
                           .half_width = eye,
                           .height = eye * 0.8,
                           .base = 7,
                           .rough = 0.2,
                           .color = is.eye,
                           .second_color = tinted(is.eye, 0.55, 0.1),
                           .mottling = 0.8,
                           .salt = 5});
    Rgba8Image picture =
        canvas.develop({.sun = 0.7, .sky = 0.75, .shade = 0.4, .shadows = false, .glow = 0.1, .level = 0.95});
    add_contact_shade(picture, 0.06 * side, 0.7);
    return picture;
}

Rgba8Image paint_ball(std::int32_t kind, std::int32_t side) {
    const std::array<LinearColor, 3> colors{{{0.72, 0.05, 0.03}, {0.04, 0.16, 0.62}, {0.80, 0.52, 0.02}}};
    Canvas canvas{side, 4};
    const double radius = side * 0.36;
    const LinearColor color = colors[static_cast<std::size_t>(kind) % colors.size()];
    draw_dome(canvas, {.x = 0.5 * side,
                       .y = 0.5 * side,
                       .half_length = radius,
                       .half_width = radius,
                       .height = radius,
                       .color = color,
                       .second_color = tinted(color, 1.25),
                       .mottling = 0.2,
                       .salt = static_cast<std::uint32_t>(kind)});
    Rgba8Image picture =
        canvas.develop({.sun = 0.95, .sky = 0.45, .shade = 0.2, .shadows = false, .glow = 0, .level = 1});
    add_contact_shade(picture, 0.10 * side, 0.9);
    return picture;
}

}  // namespace tessera::painting
