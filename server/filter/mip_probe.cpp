#include "server/filter/mip_probe.h"

#include <algorithm>
#include <bit>

#include "server/filter/each_footprint.h"

namespace tessera {

namespace {

/// Where a coordinate lies between the centres of two texels of a level.
struct Between {
    std::int64_t first = 0;
    float share = 0;  ///< Of the second.
};

Between between(int level, std::int64_t texel, double in_texel) noexcept {
    if (level == 0)
        return in_texel < 0.5 ? Between{texel - 1, static_cast<float>(in_texel + 0.5)}
                              : Between{texel, static_cast<float>(in_texel - 0.5)};
    const std::int64_t from = texel - (std::int64_t{1} << (level - 1));
    const std::int64_t rest = from & ((std::int64_t{1} << level) - 1);
    return {from >> level, static_cast<float>((static_cast<double>(rest) + in_texel) * halved(level))};
}

Floats4 least_of(Floats4 a, Floats4 b) noexcept { return a < b ? a : b; }
Floats4 most_of(Floats4 a, Floats4 b) noexcept { return a > b ? a : b; }

}  // namespace

double log2_of(double v) noexcept {
    // v = m·2^e, m between √½ and √2; ln m = 2·artanh t, t = (m − 1)/(m + 1), |t| < 0.172
    const auto bits = std::bit_cast<std::uint64_t>(v);
    auto exponent = static_cast<int>(bits >> 52) - 1023;
    double m = std::bit_cast<double>((bits & 0xfffffffffffff) | 0x3ff0000000000000);
    if (m > 1.4142135623730951) {
        m *= 0.5;
        ++exponent;
    }
    const double t = (m - 1) / (m + 1), square = t * t;
    const double series =
        1 + square * (1.0 / 3 + square * (1.0 / 5 + square * (1.0 / 7 + square * (1.0 / 9 + square / 11))));
    return exponent + t * series * (2 / 0.69314718055994531);
}

Floats4 MipProbe::bilinear(int level, const LatticePoint& at, Reading& reading) {
    const Between x = between(level, at.x, at.in_x), y = between(level, at.y, at.in_y);
    reading.texels += 4;
    Floats4 a, b, c, d;
    const std::int64_t i = x.first & 255, j = y.first & 255;
    if (i < 255 && j < 255) {
        const std::uint16_t* texel = texels_.at(level, x.first >> 8, y.first >> 8, reading).texel(i, j);
        a = floats_of(load_steps(texel));
        b = floats_of(load_steps(texel + 4));
        c = floats_of(load_steps(texel + 4 * page_side_texels));
        d = floats_of(load_steps(texel + 4 * page_side_texels + 4));
    } else {
        const auto texel = [&](std::int64_t u, std::int64_t v) {
            return floats_of(load_steps(texels_.at(level, u >> 8, v >> 8, reading).texel(u & 255, v & 255)));
        };
        a = texel(x.first, y.first);
        b = texel(x.first + 1, y.first);
        c = texel(x.first, y.first + 1);
        d = texel(x.first + 1, y.first + 1);
    }
    if (level == 0) {
        first_x_ = x.first;
        first_y_ = y.first;
        least_ = least_of(least_of(a, b), least_of(c, d));
        most_ = most_of(most_of(a, b), most_of(c, d));
    }
    const Floats4 upper = a + (b - a) * x.share, lower = c + (d - c) * x.share;
    return upper + (lower - upper) * y.share;
}

double MipProbe::bound_of_four(const Footprint& footprint, const Doubles4& steps) const noexcept {
    const FootprintBox box = box_of(footprint);
    if (footprint.x + floor_of(box.left) < first_x_ || footprint.x + floor_of(box.right) > first_x_ + 1 ||
        footprint.y + floor_of(box.top) < first_y_ || footprint.y + floor_of(box.bottom) > first_y_ + 1)
        return bound_of_any(steps);
    double furthest = 0;
    for (int c = 0; c < 4; ++c)
        furthest = std::max(
            {furthest, steps[c] - static_cast<double>(least_[c]), static_cast<double>(most_[c]) - steps[c]});
    return furthest * (255.0 / 65535.0);
}

Floats4 MipProbe::trilinear(double lod, const LatticePoint& at, Reading& reading) {
    if (!(lod > 0)) return bilinear(0, at, reading);
    if (lod >= max_level) return bilinear(max_level, at, reading);
    const auto level = static_cast<int>(lod);
    const auto share = static_cast<float>(lod - level);
    const Floats4 fine = bilinear(level, at, reading);
    if (share == 0) return fine;
    const Floats4 coarse = bilinear(level + 1, at, reading);
    return fine + (coarse - fine) * share;
}

}  // namespace tessera
