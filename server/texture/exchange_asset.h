#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/texture/rgb8_image.h"

namespace tessera {

/// A small image of yes and no, one bit a texel: the shape of a patch.
struct BitMask {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<std::uint8_t>
        bytes;  ///< Rows of (width + 7) / 8 bytes, the leftmost texel in the highest bit.

    BitMask() = default;
    BitMask(std::int32_t w, std::int32_t h)
        : width{w}, height{h}, bytes(std::size_t((w + 7) / 8) * std::size_t(h)) {}
    bool at(std::int32_t x, std::int32_t y) const noexcept {
        return (bytes[index(x, y)] >> (7 - x % 8) & 1) != 0;
    }
    void set(std::int32_t x, std::int32_t y) noexcept {
        bytes[index(x, y)] = static_cast<std::uint8_t>(bytes[index(x, y)] | 128 >> x % 8);
    }
    bool operator==(const BitMask&) const = default;

  private:
    std::size_t index(std::int32_t x, std::int32_t y) const noexcept {
        return std::size_t(y) * std::size_t((width + 7) / 8) + std::size_t(x / 8);
    }
};

/// How the plane is covered; what each needs of an asset is said at its parts.
enum class ExchangeMethod : std::uint8_t {
    content_exchange,  ///< Lutz et al. 2019: a patch map, contents for each patch.
    interchange,       ///< Kolář et al. 2016: patches of any shape, on either of two tiles.
    wang,              ///< One square patch whose contents are corner-coloured tiles.
};

/// The word for it in asset.json, in scene files and for --method.
constexpr std::string_view method_name(ExchangeMethod method) noexcept {
    switch (method) {
        case ExchangeMethod::interchange:
            return "interchange";
        case ExchangeMethod::wang:
            return "wang";
        case ExchangeMethod::content_exchange:
            break;
    }
    return "content_exchange";
}

/// What all by-example textures are made of (DESIGN section 2): the plane shows the periodic tile, except
/// where a patch shows one of its contents, a part of the exemplar with a shape of its own: I = tile + Σ
/// shape·(content − tile). Shapes that are shown together never overlap. proto/asset.proto says how this is
/// kept in files; read_exchange_asset() has checked it.
struct ExchangeAsset {
    static constexpr int max_contents = 255;  ///< Of a patch, beside its own.
    static constexpr int max_groups = 256;

    struct Offset {
        std::int32_t x = 0, y = 0;  ///< The exemplar texel that lies on the box's first texel.
        bool operator==(const Offset&) const = default;
    };
    /// What a person says of a content: dropped ones are never shown; pinned ones outlast a new preparation.
    enum class Standing : std::uint8_t { chosen, pinned, dropped };
    struct Content {
        Offset at;
        BitMask shape;  ///< As large as the patch's box.
        Standing standing = Standing::chosen;
        std::uint8_t corners = 0;  ///< wang: colours of top left, top right, bottom left, bottom right, two
                                   ///< bits each from the lowest on.
    };
    /// interchange: on which tiles a patch may lie when every tile decides for itself. No patch of one set
    /// overlaps one of another, whatever neighbours they lie on. `none`: only where a whole unit is decided
    /// at once.
    enum class Set : std::uint8_t { none, a, b };
    struct Patch {
        /// First texel of the box relative to the tile. content_exchange: 0 to side − 1, the box wraps.
        /// interchange: the box lies in the tile's rhombus |x − side/2| + |y − side/2| ≤ side, so −side/2 to
        /// 3·side/2. wang: 0.
        std::int32_t x = 0, y = 0;
        std::int32_t width = 0, height = 0;  ///< content_exchange: at most side / 2. wang: side.
        /// content_exchange: content 0, the tile's own, is not listed; shapes keep to the patch's part of the
        /// patch map. interchange: exactly one. wang: one for each tile.
        std::vector<Content> contents;
        Set set = Set::none;
        /// interchange: patches of one group, 1 to max_groups, are shown together, or none of them. They do
        /// not overlap, are in no set, and reach over several tiles: x and y are below 8·side. 0: shown
        /// alone.
        std::uint16_t group = 0;
    };
    /// Further images, aligned with the exemplar texel by texel: decisions are made once and shared.
    struct Channel {
        std::string name;  ///< "normal", "roughness", "height"
        Rgb8Image exemplar;
        Rgb8Image tile;
    };

    ExchangeMethod method = ExchangeMethod::content_exchange;
    Rgb8Image exemplar;  ///< wang: the tiles, side by side.
    Rgb8Image tile;      ///< tile_side × tile_side, repeats
    /// content_exchange: the patch map, tile_side × tile_side, each below patches.size(). Else empty.
    std::vector<std::uint16_t> labels;
    std::int32_t tile_side = 0;     ///< A power of two, 16 to 4096.
    std::int32_t blend_texels = 0;  ///< Even. Boxes and half of it around them lie inside the exemplar.
    std::vector<Patch> patches;     ///< At most 65535; so are all their contents together.
    std::vector<Channel> channels;
};

}  // namespace tessera
