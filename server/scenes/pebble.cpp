#include "server/scenes/pebble.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

/// What the stones of a river bank are made of. Colours are linear light.
struct Rock {
    int share;  ///< Of 100 stones.
    LinearColor color, second;
    double mottling, speckles, bands, veins, gloss;
};

constexpr std::array<Rock, 10> rocks{{
    {20, {0.165, 0.165, 0.160}, {0.255, 0.250, 0.240}, 0.7, 0.35, 0.0, 0.25, 0.20},  // grey limestone
    {14, {0.085, 0.095, 0.105}, {0.130, 0.140, 0.150}, 0.6, 0.20, 0.2, 0.55, 0.35},  // blue-grey basalt
    {16, {0.310, 0.245, 0.170}, {0.410, 0.335, 0.245}, 0.7, 0.30, 0.6, 0.05, 0.10},  // tan sandstone
    {9, {0.195, 0.132, 0.092}, {0.290, 0.205, 0.145}, 0.8, 0.25, 0.5, 0.10, 0.15},   // brown chert
    {8, {0.400, 0.370, 0.315}, {0.540, 0.510, 0.455}, 0.6, 0.10, 0.0, 0.15, 0.40},   // milky quartz
    {8, {0.190, 0.112, 0.088}, {0.260, 0.165, 0.130}, 0.6, 0.30, 0.4, 0.40, 0.15},   // red siltstone
    {10, {0.330, 0.315, 0.290}, {0.200, 0.190, 0.180}, 0.3, 1.00, 0.0, 0.05, 0.20},  // granite
    {6, {0.120, 0.135, 0.105}, {0.185, 0.200, 0.155}, 0.7, 0.25, 0.3, 0.35, 0.30},   // green schist
    {5, {0.045, 0.046, 0.050}, {0.070, 0.071, 0.076}, 0.5, 0.15, 0.3, 0.60, 0.45},   // dark slate
    {4, {0.340, 0.225, 0.175}, {0.440, 0.320, 0.265}, 0.5, 0.70, 0.0, 0.10, 0.20},   // pink feldspar
}};

const Rock& pick_rock(Dice& dice) {
    auto draw = static_cast<int>(dice.bits() % 100);
    for (const Rock& rock : rocks)
        if ((draw -= rock.share) < 0) return rock;
    return rocks.front();
}

/// A uniformly random direction, by rejection: no sine, no cosine.
void random_direction(Dice& dice, double& x, double& y) {
    double length = 0.0;
    do {
        x = dice.uniform(-1.0, 1.0);
        y = dice.uniform(-1.0, 1.0);
        length = x * x + y * y;
    } while (length > 1.0 || length < 0.01);
    x /= std::sqrt(length);
    y /= std::sqrt(length);
}

double smooth_min(double a, double b, double width) noexcept {
    const double h = std::clamp(0.5 + 0.5 * (b - a) / width, 0.0, 1.0);
    return mix_linear(b, a, h) - width * h * (1.0 - h);
}

}  // namespace

Pebble make_pebble(double radius, Dice& dice) {
    Pebble pebble;
    random_direction(dice, pebble.axis_x, pebble.axis_y);
    const double elongation = 1.0 + 0.75 * dice.uniform(0.0, 1.0) * dice.uniform(0.2, 1.0);
    pebble.half_length = radius * std::sqrt(elongation);
    pebble.half_width = radius / std::sqrt(elongation);
    pebble.half_height = pebble.half_width * dice.uniform(0.42, 0.72);
    pebble.squareness = dice.uniform(0.0, 0.9);
    pebble.flatness = dice.uniform(0.0, 0.8);
    pebble.taper = dice.uniform(-0.22, 0.22);
    pebble.roughness = dice.uniform(0.35, 1.0);
    for (Pebble::Facet& facet : pebble.facets) {
        random_direction(dice, facet.direction_x, facet.direction_y);
        facet.offset = dice.uniform(0.85, 1.35);
        facet.steepness = dice.uniform(0.2, 0.9);
    }
    pebble.salt = static_cast<std::uint32_t>(dice.bits());

    const Rock& rock = pick_rock(dice);
    const double lightness = dice.uniform(0.78, 1.25), warmth = dice.uniform(-0.06, 0.06);
    const LinearColor tint{lightness * (1.0 + warmth), lightness, lightness * (1.0 - warmth)};
    for (std::size_t i = 0; i < 3; ++i) {
        pebble.color[i] = rock.color[i] * tint[i];
        pebble.second_color[i] = rock.second[i] * tint[i];
    }
    pebble.mottling = rock.mottling * dice.uniform(0.6, 1.0);
    pebble.speckles = rock.speckles * dice.uniform(0.5, 1.0);
    pebble.bands = dice.chance(rock.bands) ? dice.uniform(0.25, 0.8) : 0.0;
    pebble.veins = dice.chance(rock.veins) ? dice.uniform(0.2, 0.75) : 0.0;
    pebble.gloss = rock.gloss * dice.uniform(0.3, 1.0);
    return pebble;
}

PebblePoint to_pebble(const Pebble& pebble, double dx, double dy) noexcept {
    return {(dx * pebble.axis_x + dy * pebble.axis_y) / pebble.half_length,
            (dy * pebble.axis_x - dx * pebble.axis_y) / pebble.half_width};
}

double surface_height(const Pebble& pebble, double dx, double dy) noexcept {
    auto [u, v] = to_pebble(pebble, dx, dy);
    if (u * u + v * v > 1.9) return outside;

    // Bend the coordinates, so that outline and surface are irregular together
    const double bend = 0.17 * pebble.roughness, crinkle = 0.035 * pebble.roughness;
    const double bu =
        bend * noise(u * 1.1, v * 1.1, pebble.salt) + crinkle * noise(u * 3.7, v * 3.7, pebble.salt + 1);
    const double bv =
        bend * noise(u * 1.1, v * 1.1, pebble.salt + 2) + crinkle * noise(u * 3.7, v * 3.7, pebble.salt + 3);
    u += bu;
    v = (v + bv) * (1.0 + pebble.taper * u);

    // A dome over a rounded square; its edge is where it meets its widest cross-section
    const double uu = u * u, vv = v * v;
    const double distance = mix_linear(uu + vv, std::sqrt(uu * uu + vv * vv), pebble.squareness);
    if (distance >= 1.0) return outside;
    double dome = std::sqrt(1.0 - mix_linear(distance, distance * distance, pebble.flatness));

    // Old breaks, long since rounded
    for (const Pebble::Facet& facet : pebble.facets) {
        const double along = u * facet.direction_x + v * facet.direction_y;
        dome = smooth_min(dome, facet.offset - facet.steepness * along, 0.16);
    }
    dome += 0.030 * pebble.roughness * noise(u * 4.3, v * 4.3, pebble.salt + 4);
    return pebble.base + pebble.half_height * dome + pebble.tilt_x * dx + pebble.tilt_y * dy;
}

LinearColor surface_color(const Pebble& pebble, double dx, double dy, double texel) noexcept {
    const auto [u, v] = to_pebble(pebble, dx, dy);
    const std::uint32_t salt = pebble.salt;

    // Mottling: two colours of one rock, in clouds
    const double cloud = fractal_noise(u * 1.4, v * 1.4, salt + 10, 4);
    double second = 0.5 + (0.9 * cloud) * pebble.mottling;

    // Bands: layers of sediment, bent
    if (pebble.bands > 0.0) {
        const double along = v * 3.4 + 0.5 * u + 0.7 * noise(u * 0.9, v * 0.9, salt + 20);
        second += pebble.bands * 0.8 * noise(along * 1.3, 0.37, salt + 21);
    }
    second = std::clamp(second, 0.0, 1.0);
    LinearColor color;
    for (std::size_t i = 0; i < 3; ++i)
        color[i] = mix_linear(pebble.color[i], pebble.second_color[i], second);

    // Speckles: grains of a texel or few, lighter and darker
    const double gx = (dx * pebble.axis_x + dy * pebble.axis_y) / texel;
    const double gy = (dy * pebble.axis_x - dx * pebble.axis_y) / texel;
    const double grain = noise(gx * 0.31, gy * 0.31, salt + 30);
    const double fine = noise(gx * 0.83, gy * 0.83, salt + 31);
    double light = 1.0 + pebble.speckles *
                             (0.55 * smooth_step(0.25, 0.6, grain) - 0.60 * smooth_step(0.25, 0.6, -grain));
    light *= 1.0 + 0.13 * fine + 0.10 * fractal_noise(gx * 0.12, gy * 0.12, salt + 32, 2);

    // Veins: quartz that filled a crack, thin lines where a smooth field crosses zero
    double vein = 0.0;
    if (pebble.veins > 0.0) {
        const double field =
            noise(u * 0.55 + 0.3, v * 0.55 + 0.4, salt + 40) + 0.12 * noise(u * 2.3, v * 2.3, salt + 41);
        const double width = 0.012 + 0.045 * smooth_step(0.0, 0.8, noise(u * 1.7, v * 1.7, salt + 42));
        vein = pebble.veins * (1.0 - smooth_step(0.3 * width, width, field < 0.0 ? -field : field));
    }
    constexpr LinearColor quartz{0.60, 0.57, 0.52};
    for (std::size_t i = 0; i < 3; ++i) color[i] = mix_linear(color[i] * light, quartz[i], vein);
    return color;
}

double reach(const Pebble& pebble) noexcept { return 1.4 * pebble.half_length + 1.0; }

double radius_towards(const Pebble& pebble, double dx, double dy) noexcept {
    const double length = std::sqrt(dx * dx + dy * dy);
    if (length < 1e-9) return pebble.half_width;
    const auto [u, v] = to_pebble(pebble, dx / length, dy / length);
    return 1.0 / std::sqrt(u * u + v * v);
}

}  // namespace tessera
