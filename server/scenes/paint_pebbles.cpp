#include "server/scenes/paint_pebbles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>

#include "server/scenes/pebble_light.h"
#include "server/scenes/pebble_pile.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// Canvas texels along each side of a texel of the picture: smooths outlines and grains.
constexpr std::int32_t oversampling = 2;

/// Of the normals: stones as steep as these are as rough as can be when seen from afar, and where all is
/// white, no roughness is to be told from another.
constexpr double relief = 0.35;

constexpr LinearColor sun_color{1.26, 1.18, 1.02};
constexpr LinearColor sky_color{0.36, 0.41, 0.50};
constexpr LinearColor bounce_color{0.060, 0.050, 0.038};  // light that the stones themselves throw back

constexpr double cliff = 2.2;  ///< Slope where a stone falls off.

struct Normal {
    double x, y, z;
};

Normal normalised(double slope_x, double slope_y) noexcept {
    const double length = std::sqrt(slope_x * slope_x + slope_y * slope_y + 1.0);
    return {-slope_x / length, -slope_y / length, 1.0 / length};
}

double wrapped(double difference, double side) noexcept {
    if (difference > 0.5 * side) return difference - side;
    return difference < -0.5 * side ? difference + side : difference;
}

/// Colour and shape of what is on top at a canvas texel.
struct Surface {
    LinearColor color;
    Normal normal;
    double gloss;
};

Surface sand_at(const PebblePile& pile, std::int32_t x, std::int32_t y) {
    const double slope_x =
        static_cast<double>(pile.height[pile.index(x + 1, y)] - pile.height[pile.index(x, y)]);
    const double slope_y =
        static_cast<double>(pile.height[pile.index(x, y + 1)] - pile.height[pile.index(x, y)]);
    const double grain = noise(x * 0.41, y * 0.41, 77) + 0.6 * noise(x * 0.9, y * 0.9, 78);
    const double light = 1.0 + 0.35 * grain;
    return {{0.115 * light, 0.088 * light, 0.060 * light}, normalised(slope_x, slope_y), 0.0};
}

Surface pebble_at(const PebblePile& pile, const Pebble& pebble, std::int32_t x, std::int32_t y) {
    const double dx = wrapped(x + 0.5 - pebble.x, pile.side), dy = wrapped(y + 0.5 - pebble.y, pile.side);
    // Slopes of this stone alone; where the next texel is beyond its edge it falls off steeply
    const double here = surface_height(pebble, dx, dy);
    constexpr double step = 0.75;
    const auto slope = [&](double ox, double oy) {
        if (const double ahead = surface_height(pebble, dx + ox, dy + oy); ahead > outside)
            return (ahead - here) / step;
        return -cliff;
    };
    // Pits and grains too small to be part of the shape
    const double gx = dx / pile.texel, gy = dy / pile.texel;
    const double pit = 0.10 * pebble.roughness;
    const double pit_x = pit * noise(gx * 0.45, gy * 0.45, pebble.salt + 50);
    const double pit_y = pit * noise(gx * 0.45, gy * 0.45, pebble.salt + 51);
    return {surface_color(pebble, dx, dy, pile.texel),
            normalised(slope(step, 0.0) + pit_x, slope(0.0, step) + pit_y), pebble.gloss};
}

Surface surface_at(const PebblePile& pile, std::int32_t x, std::int32_t y) {
    const std::int32_t owner = pile.owner[pile.index(x, y)];
    return owner < 0 ? sand_at(pile, x, y)
                     : pebble_at(pile, pile.pebbles[static_cast<std::size_t>(owner)], x, y);
}

/// `open` is how much of the sky reaches this place.
LinearColor lit(const PebblePile& pile, const Surface& surface, std::int32_t x, std::int32_t y, double open) {
    const Normal n = surface.normal;

    const double facing = std::max(0.0, n.x * sun_x + n.y * sun_y + n.z * sun_z);
    const double sun = facing > 0.0 ? sunlight(pile, x, y) : 0.0;
    const double sky = open * open * (0.55 + 0.45 * n.z);

    // A broad shine: Blinn's half vector, the viewer straight above, to the 16th power
    constexpr double half_z = 0.9244;  // (sun + viewer) / |sun + viewer|
    constexpr double half_x = sun_x / (2.0 * half_z), half_y = sun_y / (2.0 * half_z);
    double shine = std::max(0.0, n.x * half_x + n.y * half_y + n.z * half_z);
    for (int i = 0; i < 4; ++i) shine *= shine;
    shine *= 0.11 * surface.gloss * sun;

    LinearColor color;
    for (std::size_t i = 0; i < 3; ++i) {
        const double light = sun_color[i] * facing * sun + sky_color[i] * sky + bounce_color[i] * open;
        color[i] = surface.color[i] * light + shine * sun_color[i];
    }
    return color;
}

std::uint8_t to_code(double linear) noexcept {
    // A soft shoulder keeps bright stones from burning out
    const double exposed = 1.12 * linear;
    const double toned = exposed < 0.6 ? exposed : 0.6 + (exposed - 0.6) / (1.0 + (exposed - 0.6) / 0.4);
    return steps_to_srgb()[to_steps(static_cast<float>(toned))];
}

/// Sky light changes slowly: once for a texel of the picture, from where the canvas stands highest.
double skylight_of_texel(const PebblePile& pile, std::int32_t left, std::int32_t top) {
    std::int32_t best_x = left, best_y = top;
    for (std::int32_t y = top; y < top + oversampling; ++y)
        for (std::int32_t x = left; x < left + oversampling; ++x)
            if (pile.height[pile.index(x, y)] > pile.height[pile.index(best_x, best_y)]) {
                best_x = x;
                best_y = y;
            }
    return skylight(pile, best_x, best_y);
}

/// Of a value from 0 to 1.
std::uint8_t to_255th(double value) noexcept {
    return static_cast<std::uint8_t>(std::clamp(value, 0.0, 1.0) * 255.0 + 0.5);
}

/// The span of heights in the pile.
struct Heights {
    double lowest, highest;
};

void paint_row(const PebblePile& pile, Heights heights, std::int32_t y, PaintedSurface& painted) {
    constexpr double share = 1.0 / (oversampling * oversampling);
    const std::int32_t width = painted.color.width;
    for (std::int32_t x = 0; x < width; ++x) {
        const std::int32_t left = x * oversampling, top = y * oversampling;
        const double open = skylight_of_texel(pile, left, top);
        LinearColor sum{};
        double slope_x = 0.0, slope_y = 0.0, gloss = 0.0, height = 0.0;
        for (std::int32_t j = 0; j < oversampling; ++j)
            for (std::int32_t i = 0; i < oversampling; ++i) {
                const Surface surface = surface_at(pile, left + i, top + j);
                const LinearColor sample = lit(pile, surface, left + i, top + j, open);
                for (std::size_t c = 0; c < 3; ++c) sum[c] += sample[c];
                slope_x += surface.normal.x / surface.normal.z * share;
                slope_y += surface.normal.y / surface.normal.z * share;
                gloss += surface.gloss * share;
                height += static_cast<double>(pile.height[pile.index(left + i, top + j)]) * share;
            }
        const std::size_t at = 3 * (std::size_t(y) * std::size_t(width) + std::size_t(x));
        for (std::size_t c = 0; c < 3; ++c)
            painted.color.bytes[at + c] = to_code(sum[c] / (oversampling * oversampling));

        // The canvas' y points down, a normal map's up
        slope_x = relief * std::clamp(slope_x, -cliff, cliff);
        slope_y = relief * std::clamp(slope_y, -cliff, cliff);
        const double half = 0.5 / std::sqrt(slope_x * slope_x + slope_y * slope_y + 1.0);
        const std::array<double, 3> normal{0.5 + slope_x * half, 0.5 - slope_y * half, 0.5 + half};
        for (std::size_t c = 0; c < 3; ++c) {
            painted.normal.bytes[at + c] = to_255th(normal[c]);
            painted.roughness.bytes[at + c] = to_255th(0.85 - 0.4 * gloss);
            painted.height.bytes[at + c] =
                to_255th((height - heights.lowest) / std::max(heights.highest - heights.lowest, 1e-9));
        }
    }
}

}  // namespace

PaintedSurface paint_pebble_surface(std::int32_t side, std::uint64_t seed, const std::stop_token& stop) {
    side = std::clamp(side, min_painting_side, max_painting_side);
    const PebblePile pile = lay_pebbles(side * oversampling, oversampling, seed, stop);

    const auto [lowest, highest] = std::minmax_element(pile.height.begin(), pile.height.end());
    const Heights heights{double{*lowest}, double{*highest}};

    const Rgb8Image blank{side, side, std::vector<std::uint8_t>(std::size_t(side) * std::size_t(side) * 3)};
    PaintedSurface painted{blank, blank, blank, blank};
    // Rows do not depend on each other: one thread for each core
    std::vector<std::jthread> painters;
    const auto count = std::clamp(static_cast<std::int32_t>(std::thread::hardware_concurrency()), 1, 16);
    for (std::int32_t first = 0; first < count; ++first)
        painters.emplace_back([&pile, heights, &painted, &stop, side, first, count] {
            for (std::int32_t y = first; y < side && !stop.stop_requested(); y += count)
                paint_row(pile, heights, y, painted);
        });
    painters.clear();
    return painted;
}

Rgb8Image paint_pebbles(std::int32_t side, std::uint64_t seed, const std::stop_token& stop) {
    return paint_pebble_surface(side, seed, stop).color;
}

}  // namespace tessera
