#include "tests/support/synthetic_asset.h"

#include <algorithm>
#include <cstdlib>

#include "shared/math/hash.h"

namespace tessera::tests {
namespace {

Rgb8Image noise(std::int32_t width, std::int32_t height, std::uint64_t seed, int constant_code) {
    Rgb8Image image{width, height, {}};
    for (std::int32_t y = 0; y < height; ++y)
        for (std::int32_t x = 0; x < width; ++x)
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

/// A group of three by three rectangles beside each other, each from a place of its own.
void add_group(ExchangeAsset& asset, std::uint16_t number, std::uint64_t seed) {
    const std::int32_t side = asset.tile_side, margin = asset.blend_texels / 2;
    const auto draw = [&](std::uint64_t what, std::int32_t below) {
        return static_cast<std::int32_t>(
            uniform_below(hash(seed, stream("group", what), number, 0), static_cast<std::uint32_t>(below)));
    };
    std::int32_t y = draw(0, 3 * side);
    const std::int32_t left = draw(1, 3 * side);
    for (std::uint64_t row = 0; row < 3; ++row) {
        const std::int32_t height = side / 4 + draw(2 + row, side * 5 / 12);
        std::int32_t x = left;
        for (std::uint64_t column = 0; column < 3; ++column) {
            const std::int32_t width = side / 4 + draw(5 + column, side * 5 / 12);
            ExchangeAsset::Patch patch;
            patch.x = x, patch.y = y, patch.width = width, patch.height = height, patch.group = number;
            BitMask shape{width, height};
            for (std::int32_t v = 0; v < height; ++v)
                for (std::int32_t u = 0; u < width; ++u) shape.set(u, v);
            const std::uint64_t place = 8 + 2 * (3 * row + column);
            patch.contents.push_back(
                {{margin + draw(place, asset.exemplar.width - width - 2 * margin + 1),
                  margin + draw(place + 1, asset.exemplar.height - height - 2 * margin + 1)},
                 std::move(shape)});
            asset.patches.push_back(std::move(patch));
            x += width;
        }
        y += height;
    }
}

}  // namespace

ExchangeAsset make_synthetic_asset(const SyntheticAssetOptions& options) {
    const std::int32_t side = options.tile_side;
    ExchangeAsset asset;
    asset.tile_side = side;
    asset.blend_texels = options.blend_texels;
    asset.tile = noise(side, side, options.seed + 1, options.constant_code);
    asset.exemplar = noise(side * 2, side * 2, options.seed, options.constant_code);

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
        const BitMask whole = region_of_patch(asset, p);
        for (std::int32_t i = 1; i < options.contents; ++i) {
            BitMask shape{whole.width, whole.height};
            for (std::int32_t y = 0; y < shape.height; ++y)
                for (std::int32_t x = 0; x < shape.width; ++x)
                    if (whole.at(x, y) && (i % 2 == 0 || (x + i) % 7 != 0 || y % 5 > 1)) shape.set(x, y);
            patch.contents.push_back(
                {{place(patch.width, 0, i), place(patch.height, 1, i)}, std::move(shape)});
        }
    }
    return asset;
}

BitMask region_of_patch(const ExchangeAsset& asset, std::size_t patch) {
    const auto& box = asset.patches[patch];
    const std::int32_t wrap = asset.tile_side - 1;
    BitMask region{box.width, box.height};
    for (std::int32_t y = 0; y < box.height; ++y)
        for (std::int32_t x = 0; x < box.width; ++x)
            if (asset.labels[std::size_t(((box.y + y) & wrap) * asset.tile_side + ((box.x + x) & wrap))] ==
                patch)
                region.set(x, y);
    return region;
}

ExchangeAsset make_synthetic_interchange(const SyntheticAssetOptions& options) {
    const std::int32_t side = options.tile_side, margin = options.blend_texels / 2;
    ExchangeAsset asset;
    asset.method = ExchangeMethod::interchange;
    asset.tile_side = side;
    asset.blend_texels = options.blend_texels;
    asset.tile = noise(side, side, options.seed + 1, options.constant_code);
    asset.exemplar = noise(side * 2, side * 2, options.seed, options.constant_code);
    for (std::int32_t i = 0; i < options.patches; ++i) {
        const auto draw = [&](std::uint64_t what, std::int32_t below) {
            return static_cast<std::int32_t>(uniform_below(hash(options.seed, stream("piece", what), i, 0),
                                                           static_cast<std::uint32_t>(below)));
        };
        ExchangeAsset::Patch patch;
        patch.width = 3 + draw(0, side / (i % 4 == 0 ? 2 : 6));
        patch.height = i % 3 == 0 ? patch.width : 3 + draw(1, side / 4);
        patch.x = -side / 2 + draw(2, 2 * side - patch.width + 1);
        patch.y = -side / 2 + draw(3, 2 * side - patch.height + 1);
        BitMask shape{patch.width, patch.height};
        bool inside = true;
        for (std::int32_t y = 0; y < patch.height; ++y)
            for (std::int32_t x = 0; x < patch.width; ++x) {
                const std::int32_t dx = 2 * x + 1 - patch.width, dy = 2 * y + 1 - patch.height;
                if (i % 3 == 0 && dx * dx + dy * dy > patch.width * patch.width) continue;
                shape.set(x, y);
                inside &= std::abs(2 * (patch.x + x) + 1 - side) + std::abs(2 * (patch.y + y) + 1 - side) <=
                          2 * side;
            }
        if (!inside) continue;
        // Set a keeps to its tile, set b to the middle of it: neither ever meets the other on a neighbour
        const bool within =
            patch.x >= 0 && patch.y >= 0 && patch.x + patch.width <= side && patch.y + patch.height <= side;
        patch.set = !within      ? ExchangeAsset::Set::none
                    : i % 2 == 0 ? ExchangeAsset::Set::a
                                 : ExchangeAsset::Set::b;
        patch.contents.push_back({{margin + draw(4, 2 * side - patch.width - 2 * margin + 1),
                                   margin + draw(5, 2 * side - patch.height - 2 * margin + 1)},
                                  std::move(shape)});
        asset.patches.push_back(std::move(patch));
    }
    for (std::int32_t g = 1; g <= options.groups; ++g)
        add_group(asset, static_cast<std::uint16_t>(g), options.seed);
    return asset;
}

ExchangeAsset make_synthetic_wang(const SyntheticAssetOptions& options) {
    const std::int32_t side = options.tile_side;
    ExchangeAsset asset;
    asset.method = ExchangeMethod::wang;
    asset.tile_side = side;
    asset.tile = noise(side, side, options.seed + 1, options.constant_code);
    asset.exemplar = noise(side * 4, side * 4, options.seed, options.constant_code);
    ExchangeAsset::Patch patch;
    patch.width = patch.height = side;
    for (std::uint8_t tile = 1; tile < 16; ++tile) {
        BitMask shape{side, side};
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t x = 0; x < side; ++x) shape.set(x, y);
        ExchangeAsset::Content content{{tile % 4 * side, tile / 4 * side}, std::move(shape)};
        content.corners = static_cast<std::uint8_t>((tile & 1) | (tile >> 1 & 1) << 2 | (tile >> 2 & 1) << 4 |
                                                    tile >> 3 << 6);
        patch.contents.push_back(std::move(content));
    }
    asset.patches.push_back(std::move(patch));
    return asset;
}

}  // namespace tessera::tests
