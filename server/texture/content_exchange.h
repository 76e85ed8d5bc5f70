#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/texture/texture.h"

namespace tessera {

/// An 8-bit RGB image, sRGB-coded, rows from the top.
struct Rgb8Image {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<std::uint8_t> bytes;  ///< 3·width·height
};

/// What content exchange is made of, in memory: proto/asset.proto says what each part means, and
/// read_content_exchange_asset() has checked it.
struct ContentExchangeAsset {
    static constexpr int max_contents = 255;  ///< Of a patch, beside its own: a content's number fits a byte.

    struct Offset {
        std::int32_t x = 0, y = 0;  ///< The exemplar texel that lies on the patch's origin.
    };
    struct Patch {
        std::int32_t x = 0, y = 0;           ///< Origin in the tile.
        std::int32_t width = 0, height = 0;  ///< Unwrapped bounding box.
        std::vector<Offset> contents;        ///< Contents 1, 2, …; content 0 is the tile's own.
    };
    Rgb8Image exemplar;
    Rgb8Image tile;                     ///< tile_side × tile_side
    std::vector<std::uint16_t> labels;  ///< tile_side × tile_side, each below patches.size()
    std::int32_t tile_side = 0;         ///< A power of two, 16 to 4096.
    std::int32_t blend_texels = 0;      ///< Even.
    std::vector<Patch> patches;
};

enum class Choice : std::uint8_t { typed, independent };

struct ContentExchangeOptions {
    std::uint64_t seed = 0;
    Choice choice = Choice::typed;
    std::uint32_t types = 4096;  ///< A power of two, 64 to 16384.
    bool blended = true;
};

/// The most that a texture of this asset may take when it is compiled: what loading checks before it
/// allocates.
std::size_t content_exchange_bytes(const ContentExchangeAsset& asset, const ContentExchangeOptions& options);

/// Beyond this a texture is refused. Too little refuses large tiles with many contents; too much lets one
/// scene starve the others. 2 GiB hold a tile of 1024 texels with 200 contents for each patch.
inline constexpr std::size_t max_content_exchange_bytes = std::size_t{2} << 30;

/// The asset's content_exchange_bytes() are at most max_content_exchange_bytes.
std::shared_ptr<const Texture> make_content_exchange_texture(const ContentExchangeAsset& asset,
                                                             const ContentExchangeOptions& options);

}  // namespace tessera
