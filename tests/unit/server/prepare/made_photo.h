#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "server/texture/rgb8_image.h"
#include "shared/math/hash.h"

namespace tessera::test {

/// Overlapping discs of many sizes and greys over a slow drift of brightness: nothing in it repeats, and its
/// opposite edges do not fit.
inline Rgb8Image made_photo(std::int32_t width, std::int32_t height, std::uint64_t seed = 7) {
    constexpr std::uint64_t discs = stream("discs"), grain = stream("grain");
    Rgb8Image image{width, height,
                    std::vector<std::uint8_t>(std::size_t{3} * static_cast<std::size_t>(width) *
                                              static_cast<std::size_t>(height))};
    const auto paint = [&](std::int32_t x, std::int32_t y, std::int64_t red, std::int64_t green,
                           std::int64_t blue) {
        if (x < 0 || y < 0 || x >= width || y >= height) return;
        const auto noise = static_cast<std::int64_t>(hash(seed, grain, x, y) % 9) - 4;
        const std::int64_t drift = 30 * x / width;
        std::uint8_t* texel =
            image.bytes.data() +
            3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
        texel[0] = static_cast<std::uint8_t>(std::clamp<std::int64_t>(red + noise + drift, 0, 255));
        texel[1] = static_cast<std::uint8_t>(std::clamp<std::int64_t>(green + noise + drift, 0, 255));
        texel[2] = static_cast<std::uint8_t>(std::clamp<std::int64_t>(blue + noise + drift, 0, 255));
    };
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x) paint(x, y, 90, 80, 60);
    const std::int32_t count = width * height / 60;
    for (std::int32_t i = 0; i < count; ++i) {
        const std::uint64_t bits = hash(seed, discs, i, 0);
        const auto cx = static_cast<std::int32_t>(uniform_below(bits, static_cast<std::uint32_t>(width)));
        const auto cy =
            static_cast<std::int32_t>(uniform_below(mix(bits), static_cast<std::uint32_t>(height)));
        const auto radius = static_cast<std::int32_t>(2 + bits % 6);
        const auto grey = static_cast<std::int64_t>(70 + (bits >> 8) % 120);
        for (std::int32_t y = -radius; y <= radius; ++y)
            for (std::int32_t x = -radius; x <= radius; ++x)
                if (x * x + y * y <= radius * radius)
                    paint(cx + x, cy + y, grey, grey - 8,
                          grey - static_cast<std::int64_t>((bits >> 20) % 40));
    }
    return image;
}

/// Fine grains of many greys, each some `grain` texels wide, without edges: what is easy to prepare.
inline Rgb8Image made_gravel(std::int32_t width, std::int32_t height, std::int32_t grain = 4) {
    constexpr std::uint64_t greys = stream("greys");
    Rgb8Image image{width, height, {}};
    const auto corner = [&](std::int32_t x, std::int32_t y) {
        return static_cast<std::int32_t>(hash(7, greys, x, y) % 180);
    };
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x) {
            const std::int32_t i = x / grain, j = y / grain, u = x % grain, v = y % grain;
            const std::int32_t above = corner(i, j) * (grain - u) + corner(i + 1, j) * u;
            const std::int32_t below = corner(i, j + 1) * (grain - u) + corner(i + 1, j + 1) * u;
            const auto grey =
                static_cast<std::uint8_t>(40 + (above * (grain - v) + below * v) / (grain * grain));
            image.bytes.insert(image.bytes.end(), {grey, grey, static_cast<std::uint8_t>(grey - 20)});
        }
    return image;
}

}  // namespace tessera::test
