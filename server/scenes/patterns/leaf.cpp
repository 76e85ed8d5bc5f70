#include "server/scenes/patterns/leaf.h"

#include <cmath>

#include "shared/math/srgb.h"

namespace tessera::painting {
namespace {

/// Up and down between −1 and 1, once for each unit; parabolas, no sine.
double wave(double t) noexcept {
    t -= static_cast<double>(whole_below(t));
    const double half = t < 0.5 ? 2 * t : 2 * t - 1;
    const double bow = 4 * half * (1 - half);
    return t < 0.5 ? bow : -bow;
}

double saw(double t) noexcept { return t - static_cast<double>(whole_below(t)); }

/// What a blade of a leaf is at a place: `inside` above 0, 0 at the rim, about 1 on the middle vein.
struct Place {
    double inside = -1;
    double vein = 0;    ///< 0 to 1.
    double pillow = 0;  ///< 0 on veins, 1 between.
};

/// A part of a leaf along an axis: `k` along, `t` across, both in lengths of the part.
Place along_axis(double k, double t, double half_width, double veins, double slant) noexcept {
    Place place;
    if (k < 0 || k > 1 || half_width <= 0) return place;
    const double across = std::abs(t);
    place.inside = 1 - across / half_width;
    const double side_vein = (k - slant * across) * veins;
    const double phase = saw(side_vein + (t > 0 ? 0.0 : 0.45));
    const double off = std::min(phase, 1 - phase);
    const double thick = 0.010 + 0.012 * (1 - k);
    place.vein = std::max(smooth_step(thick * 1.5, thick * 0.5, across),
                          0.65 * smooth_step(0.11, 0.03, off) * smooth_step(0.02, 0.12, place.inside));
    place.pillow = 4 * off * (1 - off) * smooth_step(0.0, 0.05, across);
    return place;
}

/// The leaf's own coordinates: (0, 0) where the stalk ends, v = 1 at the tip.
Place place_of(const Leaf& leaf, double u, double v) noexcept {
    const double s = std::abs(u);
    switch (leaf.kind) {
        case Leaf::Kind::beech: {
            const double w = 1.62 * std::sqrt(std::max(0.0, v)) * (1 - v) * (0.55 + 0.45 * (1 - v)) * 0.58;
            return along_axis(v, u, w + 0.010 * (saw(v * 13 - s * 1.5) - 0.5), 11, 0.9);
        }
        case Leaf::Kind::willow: {
            const double w = 0.30 * std::sqrt(std::max(0.0, v)) * (1 - v * v);
            return along_axis(v, u, w, 16, 1.6);
        }
        case Leaf::Kind::birch: {
            const double w = v < 0.25
                                 ? 0.37 * std::sqrt(std::max(0.0, v / 0.25)) * (1.5 - 0.5 * v / 0.25) * 0.98
                                 : 0.363 * (1 - v) / 0.75 * (1 + 0.25 * (v - 0.25));
            return along_axis(v, u, w + 0.030 * (saw(v * 11 - s) - 0.5) + 0.012 * (saw(v * 33) - 0.5), 10,
                              0.75);
        }
        case Leaf::Kind::oak: {
            const double body = 0.50 * std::sqrt(std::max(0.0, v * (1 - v))) * (0.55 + 0.50 * v);
            const double lobes = 1 + 0.27 * wave(v * 4.4 - 0.30 - s * 0.9);
            return along_axis(v, u, body * lobes, 4.6, 0.55);
        }
        case Leaf::Kind::maple: {
            // Five lobes round the stalk's end, each with teeth of its own
            static constexpr struct {
                double x, y, length, width;
            } lobes[] = {{0, 1, 1.0, 0.20},
                         {0.70, 0.714, 0.90, 0.19},
                         {-0.70, 0.714, 0.90, 0.19},
                         {0.985, -0.17, 0.58, 0.15},
                         {-0.985, -0.17, 0.58, 0.15}};
            Place best;
            for (const auto& lobe : lobes) {
                const double k = (u * lobe.x + v * lobe.y) / lobe.length,
                             t = (u * lobe.y - v * lobe.x) / lobe.length;
                if (k < 0 || k > 1) continue;
                const double spread =
                    k < 0.45 ? mix_linear(0.55, 1.0, smooth_step(0, 0.45, k)) : (1 - k) / 0.55;
                const double step = saw(k * 3.2 + 0.30), tooth = step < 0.8 ? step / 0.8 : (1 - step) / 0.2;
                const double teeth = 0.78 + 0.75 * tooth * smooth_step(0.15, 0.4, k);
                const Place part = along_axis(k, t, lobe.width / lobe.length * spread * teeth, 7, 0.85);
                if (part.inside > best.inside) best = part;
            }
            // A palm that joins them
            const double dv = v - 0.18, r = std::sqrt(u * u * 0.85 + dv * dv);
            const double palm = (0.37 - r) / 0.37;
            if (palm > 0) {
                double nearest = 1;
                for (const auto& lobe : lobes)
                    if (u * lobe.x + v * lobe.y > 0)
                        nearest = std::min(nearest, std::abs(u * lobe.y - v * lobe.x));
                best.inside = std::max(best.inside, palm);
                best.vein = std::max(best.vein, smooth_step(0.020, 0.006, nearest));
                best.pillow = std::max(best.pillow, smooth_step(0.0, 0.08, nearest));
            }
            return best;
        }
        case Leaf::Kind::ginkgo: {
            const double r = std::sqrt(u * u + v * v);
            if (v < 0.12 * s - 0.02 || r < 1e-6) return {};
            const double angle = u / (r + v);
            const double rim = 0.84 + 0.035 * wave(angle * 5) + 0.02 * wave(angle * 13 + 0.3) -
                               0.24 * smooth_step(0.09, 0.0, std::abs(angle)) -
                               0.25 * smooth_step(0.34, 0.62, std::abs(angle));
            Place place;
            place.inside = std::min((rim - r) / rim * 1.4, (0.60 - std::abs(angle)) * 4);
            const double ray = saw(angle * 26);
            place.vein = 0.5 * smooth_step(0.22, 0.05, std::min(ray, 1 - ray));
            place.pillow = 4 * ray * (1 - ray) * 0.5;
            return place;
        }
    }
    return {};
}

}  // namespace

void add_contact_shade(Rgba8Image& picture, double reach, double strength) {
    const std::int32_t w = picture.width, h = picture.height, r = static_cast<std::int32_t>(reach);
    std::vector<double> weights, across(std::size_t(w) * std::size_t(h)), both(across.size());
    double whole = 0;
    for (std::int32_t i = -r; i <= r; ++i) {
        const double t = 1 - (i * i) / (reach * reach + 1);
        weights.push_back(t * t);
        whole += t * t;
    }
    const auto spread = [&](const std::vector<double>& from, std::vector<double>& to, std::int32_t dx,
                            std::int32_t dy) {
        for (std::int32_t y = 0; y < h; ++y)
            for (std::int32_t x = 0; x < w; ++x) {
                double sum = 0;
                for (std::int32_t i = -r; i <= r; ++i) {
                    const std::int32_t px = x + i * dx, py = y + i * dy;
                    if (px >= 0 && py >= 0 && px < w && py < h)
                        sum += weights[std::size_t(i + r)] *
                               from[std::size_t(py) * std::size_t(w) + std::size_t(px)];
                }
                to[std::size_t(y) * std::size_t(w) + std::size_t(x)] = sum / whole;
            }
    };
    std::vector<double> cover(across.size());
    for (std::size_t i = 0; i < cover.size(); ++i) cover[i] = picture.bytes[4 * i + 3] / 255.0;
    spread(cover, across, 1, 0);
    spread(across, both, 0, 1);
    for (std::size_t i = 0; i < cover.size(); ++i) {
        const std::int32_t x = static_cast<std::int32_t>(i) % w, y = static_cast<std::int32_t>(i) / w;
        const double rim = std::min(std::min(x, w - 1 - x), std::min(y, h - 1 - y));
        const double shade = strength * both[i] * smooth_step(-1.0, 3.0, rim);
        const double alpha = cover[i] + (1 - cover[i]) * shade;
        std::uint8_t* texel = picture.bytes.data() + 4 * i;
        texel[3] = static_cast<std::uint8_t>(alpha * 255 + 0.5);
        for (std::size_t c = 0; c < 3; ++c) {
            const double light = double{from_srgb(texel[c])} * cover[i];
            texel[c] = texel[3] == 0 ? std::uint8_t{0}
                                     : steps_to_srgb()[to_steps(static_cast<float>(light / alpha))];
        }
    }
}

Rgba8Image paint_leaf(const Leaf& leaf, std::int32_t side) {
    Canvas canvas{side, 3};
    const double size = side;
    // Where the stalk ends, and how long the blade is
    const bool is_fan = leaf.kind == Leaf::Kind::ginkgo, is_palm = leaf.kind == Leaf::Kind::maple;
    const double length = size * (is_fan ? 0.80 : is_palm ? 0.66 : 0.80);
    const double x0 = 0.5 * size, y0 = size * (is_fan ? 0.78 : is_palm ? 0.72 : 0.865);
    const double bend = 0.10 * noise(0.5, 0.3, leaf.salt) + 0.03;
    const double px = 1 / size * 128;  // details keep their size in parts of the leaf
    draw_blade(canvas, {.x = x0,
                        .y = y0 - 0.01 * size,
                        .along = {0.10, 0.994987},
                        .length = size * 0.965 - y0,
                        .half_width = 0.014 * size,
                        .bend = 0.02 * size,
                        .widest = 0.6,
                        .blunt = 0.8,
                        .base = 3.0,
                        .lift = 0.8,
                        .crease = 0.8,
                        .root_color = tinted(leaf.heart, 0.75),
                        .middle_color = tinted(leaf.heart, 0.6),
                        .tip_color = tinted(leaf.heart, 0.42)});
    canvas.draw({0, 0, size, size}, [&](double x, double y, Paint& paint) {
        double u = (x - x0) / length, v = (y0 - y) / length;
        u -= bend * v * v;
        u += 0.010 * noise(x * 0.07 * px, y * 0.07 * px, leaf.salt + 1);
        const Place at = place_of(leaf, u, v);
        if (at.inside <= 0) return false;
        const double edge = smooth_step(0.55, 0.0, at.inside);
        const double patch = fractal_noise(x * 0.045 * px, y * 0.045 * px, leaf.salt + 2, 4);
        const double fleck = fractal_noise(x * 0.16 * px, y * 0.16 * px, leaf.salt + 3, 3);
        const double roll = noise(u * 1.7 + 4.0, v * 1.7, leaf.salt + 4);
        paint.height =
            2.6 + size / 128 *
                      (leaf.curl * (9.0 * u * u + 5.0 * (v - 0.45) * (v - 0.45)) + 2.4 * leaf.curl * roll +
                       1.15 * at.pillow * smooth_step(0.0, 0.3, at.inside) - 0.5 * at.vein);
        LinearColor color =
            blend(leaf.heart, leaf.rim, std::clamp(0.85 * edge + 0.55 * patch + 0.10, 0.0, 1.0));
        const double stain = leaf.stained * smooth_step(0.15, 0.55, fleck + 0.5 * patch + 0.35 * edge - 0.1);
        color = blend(color, leaf.stain, std::clamp(stain, 0.0, 1.0));
        color = blend(color, tinted(leaf.heart, 1.35), 0.55 * at.vein);
        const double dry = leaf.stained * smooth_step(0.05, 0.0, at.inside);
        paint.color = tinted(blend(color, leaf.stain, 0.8 * dry), 0.92 + 0.16 * at.pillow);
        return true;
    });
    Rgba8Image picture = canvas.develop(
        {.sun = 0.62, .sky = 1.1, .shade = 0.25, .shadows = false, .glow = 0.05, .level = 0.80});
    add_contact_shade(picture, size / 128 * 7, 0.85);
    return picture;
}

}  // namespace tessera::painting
