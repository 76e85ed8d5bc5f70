#include "server/scenes/patterns/petals.h"

#include <cmath>

#include "server/scenes/patterns/leaf.h"
#include "shared/math/hash.h"

namespace tessera::painting {
namespace {

/// A petal from its root at (x, y), broad towards its notched end.
void draw_petal(Canvas& canvas, double x, double y, Direction d, double length, double base, double light,
                std::uint32_t salt) {
    const Direction side = beside(d);
    const double reach = length * 1.1;
    canvas.draw({x - reach, y - reach, x + reach, y + reach}, [&](double px, double py, Paint& paint) {
        const double dx = px - x, dy = py - y;
        const double k = (dx * d.x + dy * d.y) / length;
        const double t = (dx * side.x + dy * side.y) / length + 0.03 * noise(k * 3, 0.5, salt);
        const double s = std::abs(t);
        if (k < 0 || k > 1) return false;
        const double half = 0.66 * std::sqrt(std::max(0.0, k * (1.0 - k * k * k)));
        const double notch = 0.13 * smooth_step(0.10, 0.0, s);
        if (s > half || k > 1 - notch) return false;
        const double across = s / half;
        const double cup =
            0.22 * length * (k - 0.35) * (k - 0.35) + 0.16 * length * across * across * (0.4 + 0.6 * k);
        const double fold = 0.05 * length * noise(k * 1.6 + 3, t * 2.5, salt + 1);
        paint.height = base + cup + fold;
        const double ray = t / (k + 0.25) * 11;
        const double beam = ray - static_cast<double>(whole_below(ray));
        const double vein = smooth_step(0.25, 0.05, std::min(beam, 1 - beam)) * smooth_step(1.0, 0.35, k);
        const LinearColor heart{0.64, 0.155, 0.26}, rim{0.90, 0.60, 0.67};
        paint.color = tinted(
            blend(heart, rim, std::clamp(smooth_step(0.0, 0.75, k) + 0.12 * across - 0.20 * vein, 0.0, 1.0)),
            light);
        return true;
    });
}

}  // namespace

Rgba8Image paint_petal(std::int32_t number, std::int32_t side) {
    Canvas canvas{side, 4};
    Dice dice{hash(6, stream("petal"), number, 0)};
    const double middle = 0.5 * side;
    if (number < single_petals) {
        const double length = side * dice.uniform(0.44, 0.58);
        draw_petal(canvas, middle, middle + 0.5 * length, {0, -1}, length, 1.5, dice.uniform(0.92, 1.05),
                   static_cast<std::uint32_t>(dice.bits()));
    } else {
        const double length = side * 0.44;
        const Direction start = any_direction(dice);
        for (int i = 0; i < 5; ++i) {
            const Direction d = turned(start, (i + dice.uniform(-0.12, 0.12)) / 5.0);
            draw_petal(canvas, middle + d.x, middle + d.y, d, length, 1.5 + 0.5 * (i % 2),
                       dice.uniform(0.92, 1.05), static_cast<std::uint32_t>(dice.bits()));
        }
        for (int i = 0; i < 17; ++i) {
            const Direction d = turned(start, (i + dice.uniform(-0.3, 0.3)) / 17.0);
            const double far = side * dice.uniform(0.08, 0.19);
            draw_blade(canvas, {.x = middle,
                                .y = middle,
                                .along = d,
                                .length = far,
                                .half_width = 0.5,
                                .bend = 0,
                                .widest = 0.5,
                                .blunt = 1,
                                .base = 4,
                                .lift = 3.5,
                                .sag = 0,
                                .crease = 0.5,
                                .root_color = {0.50, 0.16, 0.16},
                                .middle_color = {0.80, 0.52, 0.52},
                                .tip_color = {0.86, 0.70, 0.60},
                                .line = 0});
            draw_dome(canvas, {.x = middle + d.x * far,
                               .y = middle + d.y * far,
                               .along = d,
                               .half_length = 1.15,
                               .half_width = 0.85,
                               .height = 1,
                               .base = 7.5,
                               .rough = 0,
                               .flat = 0,
                               .color = {0.86, 0.55, 0.09},
                               .second_color = {},
                               .mottling = 0,
                               .salt = 0});
        }
    }
    Rgba8Image picture = canvas.develop(
        {.sun = 0.60, .sky = 0.95, .shade = 0.25, .shadows = false, .glow = 0.10, .level = 0.92});
    add_contact_shade(picture, 0.07 * side, 0.8);
    return picture;
}

}  // namespace tessera::painting
