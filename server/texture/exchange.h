#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
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

/// Numbers to be filtered under the decisions of a by-example texture: as large as the asset's images.
struct DataImages {
    Rgb16Image exemplar, tile;
};

/// One or more of them, evaluated together: what is shown where is found out once for all.
class ExchangeData {
  public:
    virtual ~ExchangeData() = default;
    ExchangeData() = default;
    ExchangeData(const ExchangeData&) = delete;
    ExchangeData& operator=(const ExchangeData&) = delete;

    /// Takes a part of a finished row: `width` texels from (x, y) of the region on; values[i] are three
    /// linear values for each of them, of the i-th image that was asked for.
    using TakeRow =
        std::function<void(std::int32_t x, std::int32_t y, std::int32_t width, const float* const* values)>;

    /// `images`: which are asked for. Hands over every texel of the region once. Else as Texture::evaluate().
    virtual Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                        std::span<const std::size_t> images,
                                        const TakeRow& take_row) const = 0;

    /// Without what is shared with the texture that it was made from.
    virtual std::size_t memory_bytes() const noexcept = 0;
};

/// A by-example texture, and what it shows where.
class ExchangeTexture : public Texture {
  public:
    /// What each texel of a level-0 region shows without blending: 0 the tile, else 1 + the number of the
    /// content, counted through all patches, dropped ones left out. Rows of region.width.
    virtual Result<std::vector<std::uint32_t>> sources(const TexelRegion& region) const = 0;

    /// The level where a unit that is drawn by itself is one texel; nothing where units tell of others.
    virtual std::optional<int> unit_level() const noexcept { return std::nullopt; }

    /// The same decisions for one to three other images.
    virtual std::shared_ptr<const ExchangeData> with_texels(std::span<const DataImages> images) const = 0;
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
