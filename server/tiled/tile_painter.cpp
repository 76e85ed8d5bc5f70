#include "server/tiled/tile_painter.h"

#include <algorithm>
#include <cmath>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

/// Premultiplied, linear, 0 to 1.
using Texel = std::array<double, 4>;

struct Canvas {
    std::int32_t width, height;
    std::vector<Texel> texels;
};

std::int32_t nearest_power_of_two(std::int64_t area) {
    // The side whose square is nearest by ratio: below side·√2 squared, that is 2·side²
    std::int32_t side = 1;
    while (side < max_tile_texels && std::int64_t{side} * side * 2 <= area) side *= 2;
    return side;
}

std::uint8_t tinted(std::uint8_t code, double factor) {
    return static_cast<std::uint8_t>(std::clamp(code * factor + 0.5, 0.0, 255.0));
}

/// One texel of a tile, flipped as asked: first transposed, then mirrored.
const std::uint8_t* source_texel(const StraightRgba8Image& image, const TileImage& part, TileRef tile,
                                 std::int32_t x, std::int32_t y) {
    const bool transposed = tile.has(TileRef::transposed);
    const std::int32_t width = transposed ? part.height : part.width;
    const std::int32_t height = transposed ? part.width : part.height;
    if (tile.has(TileRef::flipped_x)) x = width - 1 - x;
    if (tile.has(TileRef::flipped_y)) y = height - 1 - y;
    if (transposed) std::swap(x, y);
    return image.bytes.data() +
           (std::size_t(part.y + y) * std::size_t(image.width) + std::size_t(part.x + x)) * 4;
}

/// How much of source texel i lies under texel o, where `sources` become `outs`: in 1/(sources·outs).
std::int64_t overlap(std::int64_t i, std::int64_t sources, std::int64_t o, std::int64_t outs) {
    return std::max<std::int64_t>(
        0, std::min((i + 1) * outs, (o + 1) * sources) - std::max(i * outs, o * sources));
}

/// Rows of `canvas` (or columns, where `down`) brought to `side` by area.
Canvas resampled(const Canvas& canvas, std::int32_t side, bool down) {
    const std::int32_t length = down ? canvas.height : canvas.width;
    if (length == side) return canvas;
    Canvas out{down ? canvas.width : side, down ? side : canvas.height, {}};
    out.texels.resize(std::size_t(out.width) * std::size_t(out.height));
    for (std::int32_t o = 0; o < side; ++o) {
        const std::int32_t first = static_cast<std::int32_t>(std::int64_t{o} * length / side);
        for (std::int32_t i = first; i < length; ++i) {
            const std::int64_t part = overlap(i, length, o, side);
            if (part == 0) break;
            const double weight = static_cast<double>(part) / length;
            for (std::int32_t k = 0; k < (down ? canvas.width : canvas.height); ++k) {
                const Texel& from =
                    canvas.texels[down ? std::size_t(i) * std::size_t(canvas.width) + std::size_t(k)
                                       : std::size_t(k) * std::size_t(canvas.width) + std::size_t(i)];
                Texel& to = out.texels[down ? std::size_t(o) * std::size_t(out.width) + std::size_t(k)
                                            : std::size_t(k) * std::size_t(out.width) + std::size_t(o)];
                for (std::size_t c = 0; c < 4; ++c) to[c] += weight * from[c];
            }
        }
    }
    return out;
}

void append_code(const Texel& texel, std::vector<std::uint8_t>& codes) {
    const double alpha = std::clamp(texel[3], 0.0, 1.0);
    const auto alpha_code = static_cast<std::uint8_t>(alpha * 255.0 + 0.5);
    for (std::size_t c = 0; c < 3; ++c)
        codes.push_back(alpha_code == 0 ? std::uint8_t{0}
                                        : steps_to_srgb()[to_steps(static_cast<float>(texel[c] / alpha))]);
    codes.push_back(alpha_code);
}

}  // namespace

TilePainter::TilePainter(const TiledMap& map)
    : map_{map}, side_{nearest_power_of_two(std::int64_t{map.tile_width} * map.tile_height)} {}

const Tileset* TilePainter::tileset_of(TileRef tile) const noexcept {
    if (tile.number() == 0) return nullptr;
    const auto above = std::ranges::upper_bound(map_.tilesets, tile.number(), {}, &Tileset::first);
    return above == map_.tilesets.begin() ? nullptr : &*std::prev(above);
}

const TileImage* TilePainter::find(TileRef tile) const noexcept {
    const Tileset* const set = tileset_of(tile);
    if (set == nullptr) return nullptr;
    const auto found = set->tiles.find(tile.number() - set->first);
    return found == set->tiles.end() ? nullptr : &found->second;
}

void TilePainter::paint(const std::vector<PlacedTile>& tiles, double opacity,
                        const std::array<double, 4>& tint, std::vector<std::uint8_t>& codes) const {
    // A tile that is the whole cell, as it is: its codes survive
    const bool plain = opacity == 1 && tint == std::array<double, 4>{1, 1, 1, 1};
    if (tiles.size() == 1 && plain && map_.tile_width == side_ && map_.tile_height == side_ &&
        tiles[0].x == 0 && tiles[0].y == 0) {
        const TileImage& part = *find(tiles[0].tile);
        if (part.width == side_ && part.height == side_) {
            for (std::int32_t y = 0; y < side_; ++y)
                for (std::int32_t x = 0; x < side_; ++x) {
                    const std::uint8_t* const texel =
                        source_texel(map_.images[part.image], part, tiles[0].tile, x, y);
                    codes.insert(codes.end(), texel, texel + 4);
                }
            return;
        }
    }

    Canvas canvas{map_.tile_width, map_.tile_height, {}};
    canvas.texels.resize(std::size_t(canvas.width) * std::size_t(canvas.height));
    for (const PlacedTile& placed : tiles) {
        const TileImage& part = *find(placed.tile);
        const bool transposed = placed.tile.has(TileRef::transposed);
        const std::int32_t width = transposed ? part.height : part.width;
        const std::int32_t height = transposed ? part.width : part.height;
        for (std::int32_t y = std::max(0, placed.y); y < std::min(canvas.height, placed.y + height); ++y)
            for (std::int32_t x = std::max(0, placed.x); x < std::min(canvas.width, placed.x + width); ++x) {
                const std::uint8_t* const code =
                    source_texel(map_.images[part.image], part, placed.tile, x - placed.x, y - placed.y);
                const double alpha = code[3] / 255.0 * opacity * tint[3];
                Texel& texel = canvas.texels[std::size_t(y) * std::size_t(canvas.width) + std::size_t(x)];
                for (std::size_t c = 0; c < 3; ++c)
                    texel[c] =
                        alpha * srgb_to_steps[tinted(code[c], tint[c])] / 65535.0 + (1 - alpha) * texel[c];
                texel[3] = alpha + (1 - alpha) * texel[3];
            }
    }
    for (const Texel& texel : resampled(resampled(canvas, side_, false), side_, true).texels)
        append_code(texel, codes);
}

void TilePainter::paint_alone(TileRef tile, std::int32_t width, std::int32_t height, std::int32_t side,
                              double opacity, const std::array<double, 4>& tint,
                              std::vector<std::uint8_t>& codes) const {
    const TileImage& part = *find(tile);
    const bool transposed = tile.has(TileRef::transposed);
    Canvas canvas{transposed ? part.height : part.width, transposed ? part.width : part.height, {}};
    const bool as_it_is = canvas.width == width && canvas.height == height && opacity == 1 &&
                          tint == std::array<double, 4>{1, 1, 1, 1};
    std::vector<std::uint8_t> painted;
    for (std::int32_t y = 0; y < canvas.height; ++y)
        for (std::int32_t x = 0; x < canvas.width; ++x) {
            const std::uint8_t* const code = source_texel(map_.images[part.image], part, tile, x, y);
            if (as_it_is) {
                painted.insert(painted.end(), code, code + 4);
                continue;
            }
            Texel& texel = canvas.texels.emplace_back();
            texel[3] = code[3] / 255.0 * opacity * tint[3];
            for (std::size_t c = 0; c < 3; ++c)
                texel[c] = texel[3] * srgb_to_steps[tinted(code[c], tint[c])] / 65535.0;
        }
    if (!as_it_is)
        for (const Texel& texel : resampled(resampled(canvas, width, false), height, true).texels)
            append_code(texel, painted);
    const std::size_t begin = codes.size();
    codes.resize(begin + std::size_t(side) * std::size_t(side) * 4);
    const std::int32_t left = (side - width) / 2, top = (side - height) / 2;
    for (std::int32_t y = 0; y < height; ++y)
        std::copy_n(painted.begin() + std::ptrdiff_t{y} * width * 4, width * 4,
                    codes.begin() + std::ptrdiff_t(begin) + ((std::ptrdiff_t{top} + y) * side + left) * 4);
}

}  // namespace tessera
