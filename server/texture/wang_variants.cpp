#include <algorithm>
#include <array>

#include "server/texture/unit_choice.h"
#include "shared/math/hash.h"

namespace tessera {

Variants wang_variants(const ExchangeAsset& asset, const Shapes& shapes, std::uint64_t seed,
                       std::uint32_t types) {
    constexpr std::int32_t side = 8;
    constexpr std::uint64_t inner = stream("wang corners"), outer = stream("wang corners of the outline");
    // Which shape each combination of corners is; the tile itself is all zeros
    constexpr std::uint16_t none = 65535;
    std::array<std::uint16_t, 256> shape_of{};
    shape_of.fill(none);
    std::uint8_t most = 0;
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        const std::uint8_t corners = asset.patches[shapes[s].patch].contents[shapes[s].content].corners;
        shape_of[corners] = static_cast<std::uint16_t>(s);
        for (int corner = 0; corner < 4; ++corner)
            most = std::max(most, static_cast<std::uint8_t>(corners >> 2 * corner & 3));
    }
    const std::uint32_t colors = most + 1u;

    Variants variants;
    variants.unit_tiles = side;
    std::vector<Shown> shown;
    for (std::uint32_t type = 0; type < types; ++type) {
        // Neighbours share the outline, whatever their types: its colours are drawn once, for opposite sides
        // alike
        const auto color = [&](std::int64_t x, std::int64_t y) {
            const bool outline = x % side == 0 || y % side == 0;
            return outline ? uniform_below(hash(seed, outer, x % side, y % side), colors)
                           : uniform_below(hash(seed, inner, type * side + x, y), colors);
        };
        shown.clear();
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x) {
                const std::uint32_t corners =
                    color(x, y) | color(x + 1, y) << 2 | color(x, y + 1) << 4 | color(x + 1, y + 1) << 6;
                // A tile that was dropped, or the tile itself: the periodic tile shows
                if (shape_of[corners] != none)
                    shown.push_back(
                        {shape_of[corners], static_cast<std::int8_t>(x), static_cast<std::int8_t>(y)});
            }
        variants.add(shown);
    }
    return variants;
}

}  // namespace tessera
