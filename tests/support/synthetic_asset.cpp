#include "tests/support/synthetic_asset.h"

#include <algorithm>

#include "shared/math/hash.h"

namespace tessera::tests {
namespace {

Rgb8Image noise(std::int32_t side, std::uint64_t seed, int constant_code) {
    Rgb8Image image{side, side, {}};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            for (std::uint64_t c = 0; c < 3; ++c) {
                // Blotches of eight texels and grain on top
                const std::uint64_t blotch = hash(seed, stream("blotch", c), x / 8, y / 8) >> 57;
                const std::uint64_t grain = hash(seed, stream("grain", c), x, y) >> 57;
                image.bytes.push_back(constant_code >= 0 ? static_cast<std::uint8_t>(constant_code)
                                                         : static_cast<std::uint8_t>(blotch + grain));
            }
    return image;
}

/// The way from a to b on a circle, shortest.
std::int32_t around(std::int32_t a, std::int32_t b, std::int32_t side) {
    const std::int32_t d = ((b - a) % side + side) % side;
    return d > side / 2 ? d - side : d;
}

}  // namespace

ExchangeAsset make_synthetic_asset(const SyntheticAssetOptions& options) {
    const std::int32_t side = options.tile_side;
    ExchangeAsset asset;
    asset.tile_side = side;
    asset.blend_texels = options.blend_texels;
    asset.tile = noise(side, options.seed + 1, options.constant_code);
    asset.exemplar = noise(side * 2, options.seed, options.constant_code);

    std::int32_t columns = 1;
    while (columns * columns < options.patches) ++columns;
    struct Point {
        std::int32_t x, y;
    };
    std::vector<Point> seeds;
    const std::int32_t cell = side / columns;
    for (std::int32_t i = 0; i < columns * columns; ++i) {
        const auto jitter = [&](std::uint64_t axis) {
            return static_cast<std::int32_t>(uniform_below(hash(options.seed, stream("jitter", axis), i, 0),
                                                           static_cast<std::uint32_t>(cell / 2 + 1)));
        };
        seeds.push_back({(i % columns * cell + jitter(0)) % side, (i / columns * cell + jitter(1)) % side});
    }
    asset.patches.resize(seeds.size());
    struct Box {
        std::int32_t left = 1 << 20, top = 1 << 20, right = -(1 << 20), bottom = -(1 << 20);
    };
    std::vector<Box> boxes(seeds.size());
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            std::size_t nearest = 0;
            std::int32_t best = 1 << 30;
            for (std::size_t p = 0; p < seeds.size(); ++p) {
                const std::int32_t dx = around(seeds[p].x, x, side), dy = around(seeds[p].y, y, side);
                if (dx * dx + dy * dy < best) best = dx * dx + dy * dy, nearest = p;
            }
            asset.labels.push_back(static_cast<std::uint16_t>(nearest));
            Box& box = boxes[nearest];
            const std::int32_t dx = around(seeds[nearest].x, x, side), dy = around(seeds[nearest].y, y, side);
            box = {std::min(box.left, dx), std::min(box.top, dy), std::max(box.right, dx),
                   std::max(box.bottom, dy)};
        }
    for (std::size_t p = 0; p < seeds.size(); ++p) {
        auto& patch = asset.patches[p];
        patch.x = (seeds[p].x + boxes[p].left + side) % side;
        patch.y = (seeds[p].y + boxes[p].top + side) % side;
        patch.width = boxes[p].right - boxes[p].left + 1;
        patch.height = boxes[p].bottom - boxes[p].top + 1;
        const std::int32_t margin = options.blend_texels / 2;
        const auto place = [&](std::int32_t extent, std::uint64_t axis, std::int32_t i) {
            const auto room = static_cast<std::uint32_t>(asset.exemplar.width - extent - 2 * margin + 1);
            return margin +
                   static_cast<std::int32_t>(uniform_below(
                       hash(options.seed, stream("place", axis), static_cast<std::int64_t>(p), i), room));
        };
        for (std::int32_t i = 1; i < options.contents; ++i)
            patch.contents.push_back({{place(patch.width, 0, i), place(patch.height, 1, i)}, {}});
    }
    return asset;
}

}  // namespace tessera::tests
