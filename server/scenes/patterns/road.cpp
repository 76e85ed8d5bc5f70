#include "server/scenes/patterns/road.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/scenes/patterns/leaf.h"
#include "server/scenes/patterns/scatter.h"
#include "server/scenes/patterns/shapes.h"
#include "shared/math/hash.h"
#include "shared/math/srgb.h"

namespace tessera::painting {
namespace {

constexpr std::int32_t grain = 4;  ///< Samples along the side of a texel.

using Premultiplied = std::array<double, 4>;

Premultiplied solid(const LinearColor& color, double alpha = 1) noexcept {
    return {color[0] * alpha, color[1] * alpha, color[2] * alpha, alpha};
}

/// What shape(u, v) says at each place of a square from −1 to 1.
template <class Shape>
Rgba8Image paint_flat(std::int32_t side, const Shape& shape) {
    Rgba8Image picture{side, side};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            Premultiplied sum{};
            for (int sample = 0; sample < grain * grain; ++sample) {
                const Premultiplied here = shape(2 * (x + (sample % grain + 0.5) / grain) / side - 1,
                                                 2 * (y + (sample / grain + 0.5) / grain) / side - 1);
                for (std::size_t c = 0; c < 4; ++c) sum[c] += here[c] / (grain * grain);
            }
            std::uint8_t* code = &picture.bytes[static_cast<std::size_t>(y * side + x) * 4];
            for (std::size_t c = 0; c < 3; ++c)
                code[c] = steps_to_srgb()[to_steps(static_cast<float>(sum[3] > 0 ? sum[c] / sum[3] : 0.0))];
            code[3] = static_cast<std::uint8_t>(std::clamp(sum[3], 0.0, 1.0) * 255 + 0.5);
        }
    return picture;
}

bool in_ellipse(double u, double v, double x, double y, double half_width, double half_height) noexcept {
    const double dx = (u - x) / half_width, dy = (v - y) / half_height;
    return dx * dx + dy * dy < 1;
}

/// `out`: which side of the foot is the outer one, −1 or 1.
Premultiplied footprint(double u, double v, double out) noexcept {
    const bool sole =
        in_ellipse(u, v, 0.02 * out, -0.38, 0.30, 0.46) || in_ellipse(u, v, 0.06 * out, 0.02, 0.20, 0.30);
    const bool heel = in_ellipse(u, v, 0.02 * out, 0.58, 0.22, 0.30) && v > 0.38;
    if (!sole && !heel) return {};
    const double tread = v * 11 - static_cast<double>(whole_below(v * 11));
    return solid({0.016, 0.013, 0.010}, tread < 0.62 ? 0.72 : 0.40);
}

Premultiplied no_entry(double u, double v) noexcept {
    const double r = std::sqrt(u * u + v * v);
    if (r > 0.92) return {};
    if (r > 0.86 || (std::abs(v) < 0.17 && std::abs(u) < 0.62)) return solid({0.86, 0.86, 0.84});
    return solid(tinted({0.62, 0.015, 0.02}, 1.05 - 0.15 * v));
}

Premultiplied warning(double u, double v) noexcept {
    // Distance inside the triangle's three sides
    const double inside = std::min(0.72 - v, 0.5 * (v + 1.02) - std::abs(u) * 0.866);
    if (inside < 0) return {};
    if (inside < 0.13) return solid({0.62, 0.015, 0.02});
    const bool mark = std::abs(u) < 0.09 - 0.04 * (v + 0.3) && v > -0.38 && v < 0.28;
    if (mark || in_ellipse(u, v, 0, 0.42, 0.09, 0.09)) return solid({0.01, 0.01, 0.012});
    return solid({0.84, 0.66, 0.06});
}

Premultiplied arrow(double u, double v) noexcept {
    const bool shaft = std::abs(u) < 0.14 && v > -0.2 && v < 0.95;
    const bool head = v > -0.95 && v < -0.15 && std::abs(u) < 0.62 * (v + 0.95) / 0.8;
    if (!shaft && !head) return {};
    // Worn by wheels
    const double worn = noise(u * 7, v * 7, 31) + 0.6 * noise(u * 23, v * 23, 32);
    return solid({0.72, 0.72, 0.69}, std::clamp(0.86 - 0.5 * std::max(worn, 0.0), 0.0, 1.0));
}

Premultiplied lamp(double u, double v, bool lit) noexcept {
    const double r = std::sqrt(u * u + v * v);
    if (r < 0.40) {
        const double core = smooth_step(0.40, 0.0, r);
        return solid(lit ? blend({0.95, 0.44, 0.02}, {1.0, 0.92, 0.55}, core)
                         : blend({0.20, 0.08, 0.01}, {0.36, 0.17, 0.03}, core));
    }
    if (r < 0.52) return solid({0.02, 0.02, 0.022});
    if (!lit || r > 1) return {};
    const double glow = smooth_step(1.0, 0.45, r);
    return solid({1.0, 0.55, 0.10}, 0.55 * glow * glow);
}

}  // namespace

Rgba8Image paint_asphalt(std::int32_t number, std::int32_t side) {
    Canvas canvas{side, 2};
    const auto salt = static_cast<std::uint32_t>(400 + number);
    canvas.fill([&](double x, double y, Paint& paint) {
        const double rough = tile_noise(x, y, side, 6, 390, salt, 2);
        const double grit = tile_noise(x, y, side, 32, 391, salt + 100, 2);
        const double light = 0.050 + 0.010 * rough + 0.030 * grit;
        paint.height = 0.5 * grit;
        paint.color = {light * 0.97, light, light * 1.04};
    });
    return canvas.develop({.sun = 0.8, .sky = 0.6, .shade = 0.3, .shadows = false, .glow = 0, .level = 1});
}

std::vector<std::uint8_t> paint_road_map(std::int32_t side) {
    std::vector<std::uint8_t> codes;
    const double unit = side / 1024.0;  // A lane's breadth is 20 of these
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            // Two bends, without sines, that begin and end along the rows
            const double t = (x + 0.5) / side, s = t < 0.5 ? 2 * t : 2 - 2 * t;
            const double bend = 120 * unit * (smooth_step(0.1, 0.9, s) * 2 - smooth_step(0.5, 1.0, s) * 1.2);
            double d = (y + 0.5 - bend) / unit;
            d -= 1024 * static_cast<double>(whole_below(d / 1024 + 0.5));
            const double off = std::abs(d);
            std::uint8_t code = off < 46 ? 1 : 0;
            if ((off < 1 && (x / static_cast<std::int32_t>(12 * unit + 0.5)) % 2 == 0) ||
                (off > 39 && off < 41))
                code = 2;
            codes.push_back(code);
        }
    return codes;
}

Rgba8Image paint_road_thing(RoadThing thing, std::int32_t side) {
    const auto plate = [&](auto shape) {
        Rgba8Image picture = paint_flat(side, shape);
        add_contact_shade(picture, 0.05 * side, 0.6);
        return picture;
    };
    switch (thing) {
        case RoadThing::left_foot:
            return paint_flat(side, [](double u, double v) { return footprint(u, v, -1); });
        case RoadThing::right_foot:
            return paint_flat(side, [](double u, double v) { return footprint(u, v, 1); });
        case RoadThing::no_entry:
            return plate(no_entry);
        case RoadThing::warning:
            return plate(warning);
        case RoadThing::arrow:
            return paint_flat(side, arrow);
        case RoadThing::lamp_out:
            return paint_flat(side, [](double u, double v) { return lamp(u, v, false); });
        case RoadThing::lamp_lit:
            break;
    }
    return paint_flat(side, [](double u, double v) { return lamp(u, v, true); });
}

}  // namespace tessera::painting
