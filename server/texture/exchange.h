#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/texture/exchange_asset.h"
#include "server/texture/texture.h"
#include "shared/result/result.h"

namespace tessera {

/// Who decides which contents are shown (DESIGN section 2, "Choices").
enum class Choice : std::uint8_t {
    typed,        ///< A quadtree of types: every level is exact, at constant cost.
    independent,  ///< content_exchange: a hash of tile and patch; expected above the tile level.
    kolar,        ///< interchange: the paper's formula and elimination, tile by tile, for comparison.
};

struct ExchangeOptions {
    std::uint64_t seed = 0;
    Choice choice = Choice::typed;
    std::uint32_t types = 0;  ///< A power of two, 64 to 16384; 0 is the method's own number.
    bool blended = true;      ///< False: hard borders, so that level 0 shows exemplar texels only.
};

/// Images of 16 bits a channel in linear steps of 1/65535: what is filtered.
struct Rgb16Image {
    std::int32_t width = 0;
    std::int32_t height = 0;
    std::vector<std::uint16_t> values;  ///< 3·width·height
};

/// A by-example texture, and what it shows where.
class ExchangeTexture : public Texture {
  public:
    /// What each texel of a level-0 region shows without blending: 0 the tile, else 1 + the number of the
    /// content, counted through all patches, dropped ones left out. Rows of region.width.
    virtual Result<std::vector<std::uint32_t>> sources(const TexelRegion& region) const = 0;

    /// The same decisions for other texels: `exemplar` and `tile` as large as the asset's. Its texels are the
    /// linear values as they are; codes of pages are 255ths of them.
    virtual std::shared_ptr<const Texture> with_texels(const Rgb16Image& exemplar,
                                                       const Rgb16Image& tile) const = 0;
};

/// The most that a texture of this asset may take when it is compiled: what loading checks before it
/// allocates.
std::size_t exchange_bytes(const ExchangeAsset& asset, const ExchangeOptions& options);

/// Beyond this a texture is refused. Too little refuses large tiles with many contents; too much lets one
/// scene starve the others.
inline constexpr std::size_t max_exchange_bytes = std::size_t{2} << 30;

/// The asset's exchange_bytes() are at most max_exchange_bytes, and its method knows options.choice.
std::shared_ptr<const ExchangeTexture> make_exchange_texture(const ExchangeAsset& asset,
                                                             const ExchangeOptions& options);

}  // namespace tessera
