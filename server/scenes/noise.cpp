#include "server/scenes/noise.h"

#include <array>

#include "shared/math/hash.h"

namespace tessera {
namespace {

/// A 32-bit finaliser (constants of C. Wellons' hash prospector): noise asks for four at every point.
constexpr std::uint32_t mix_32(std::uint32_t h) noexcept {
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    return h ^ (h >> 16);
}

/// The product of a random gradient at a lattice point and the offset from there.
double slope(std::int64_t ix, std::int64_t iy, double dx, double dy, std::uint32_t salt) noexcept {
    constexpr double near = 0.923879532511287, far = 0.382683432365090;  // cos and sin of 22.5°
    constexpr std::array<std::array<double, 2>, 8> gradients{{{near, far},
                                                              {far, near},
                                                              {-far, near},
                                                              {-near, far},
                                                              {-near, -far},
                                                              {-far, -near},
                                                              {far, -near},
                                                              {near, -far}}};
    const auto x = static_cast<std::uint32_t>(ix), y = static_cast<std::uint32_t>(iy);
    const auto& g = gradients[mix_32(x * 0x9e3779b1u ^ mix_32(y + salt)) >> 29];
    return g[0] * dx + g[1] * dy;
}

constexpr double fade(double t) noexcept { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }

constexpr std::int64_t wrap(std::int64_t i, std::int32_t period) noexcept {
    return period <= 0 ? i : ((i % period) + period) % period;
}

}  // namespace

double noise(double x, double y, std::uint32_t salt, std::int32_t period) noexcept {
    const std::int64_t ix = whole_below(x), iy = whole_below(y);
    const double dx = x - static_cast<double>(ix), dy = y - static_cast<double>(iy);
    const std::int64_t x0 = wrap(ix, period), x1 = wrap(ix + 1, period);
    const std::int64_t y0 = wrap(iy, period), y1 = wrap(iy + 1, period);
    const double u = fade(dx), v = fade(dy);
    const double top = mix_linear(slope(x0, y0, dx, dy, salt), slope(x1, y0, dx - 1.0, dy, salt), u);
    const double bottom =
        mix_linear(slope(x0, y1, dx, dy - 1.0, salt), slope(x1, y1, dx - 1.0, dy - 1.0, salt), u);
    return 1.5 * mix_linear(top, bottom, v);
}

double fractal_noise(double x, double y, std::uint32_t salt, int octaves, std::int32_t period) noexcept {
    double sum = 0.0, strength = 0.6;
    for (int i = 0; i < octaves; ++i) {
        sum += strength * noise(x, y, salt + static_cast<std::uint32_t>(i) * 0x51ed27u, period);
        x = 2.0 * x + 0.37 * (period > 0 ? 0.0 : 1.0);  // lattices that share their zeros would show
        y = 2.0 * y + 0.71 * (period > 0 ? 0.0 : 1.0);
        period *= 2;
        strength *= 0.5;
    }
    return sum;
}

std::uint64_t Dice::bits() noexcept { return hash(key_, stream("dice"), drawn_++, 0); }

double Dice::uniform(double from, double to) noexcept {
    return mix_linear(from, to, static_cast<double>(bits() >> 11) * 0x1p-53);
}

}  // namespace tessera
