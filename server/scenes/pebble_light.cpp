#include "server/scenes/pebble_light.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tessera {
namespace {

double height_at(const PebblePile& pile, std::int32_t x, std::int32_t y) noexcept {
    return static_cast<double>(pile.height[pile.index(x, y)]);
}

std::int32_t nearest(double value) noexcept { return static_cast<std::int32_t>(whole_below(value + 0.5)); }

}  // namespace

double sunlight(const PebblePile& pile, std::int32_t x, std::int32_t y) noexcept {
    const double here = height_at(pile, x, y);
    const double flat = std::sqrt(sun_x * sun_x + sun_y * sun_y);
    const double rise = sun_z / flat, step_x = sun_x / flat, step_y = sun_y / flat;
    const double longest = std::min(70.0 * pile.texel, static_cast<double>(pile.side - 1));
    // The most that anything rises above the ray, as seen from here: half a sun's width is full shadow
    double worst = -1.0;
    for (double t = 1.5 * pile.texel; t < longest; t += std::max(1.0, 0.06 * t)) {
        const double over =
            height_at(pile, nearest(x + t * step_x), nearest(y + t * step_y)) - here - rise * t;
        worst = std::max(worst, over / (t + 2.0 * pile.texel));
    }
    return 1.0 - smooth_step(-0.10, 0.12, worst);
}

double skylight(const PebblePile& pile, std::int32_t x, std::int32_t y) noexcept {
    constexpr double diagonal = 0.707106781186548;
    constexpr std::array<std::array<double, 2>, 8> directions{{{1, 0},
                                                               {diagonal, diagonal},
                                                               {0, 1},
                                                               {-diagonal, diagonal},
                                                               {-1, 0},
                                                               {-diagonal, -diagonal},
                                                               {0, -1},
                                                               {diagonal, -diagonal}}};
    const double here = height_at(pile, x, y);
    const double longest = std::min(44.0 * pile.texel, static_cast<double>(pile.side - 1));
    double open = 0.0;
    for (const auto& [dx, dy] : directions) {
        // The horizon in this direction, as the sine of its elevation
        double steepest = 0.0;
        for (double t = 1.5 * pile.texel; t < longest; t *= 1.5) {
            const double over = height_at(pile, nearest(x + t * dx), nearest(y + t * dy)) - here;
            if (over > steepest * t) steepest = over / t;
        }
        const double sine = steepest / std::sqrt(1.0 + steepest * steepest);
        open += 1.0 - sine;
    }
    return open / static_cast<double>(directions.size());
}

}  // namespace tessera
