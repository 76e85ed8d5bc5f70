#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "server/prepare/perceptual.h"
#include "server/prepare/quilting.h"
#include "server/texture/exchange_asset.h"

namespace tessera {

/// Finds where in the photograph a square of the tile might be replaced: cheaply, before anything is cut.
class PlaceSearch {
  public:
    /// Squares keep `margin` texels from the photograph's border. Both outlive this.
    PlaceSearch(const PerceptualImage& photo, const QuiltedTile& tile, std::int32_t margin);

    /// Displacements of the photograph against the tile, downwards and modulo the tile's side, that are
    /// allowed. Whoever looks in another band finds something else.
    struct Band {
        std::int32_t first = 0, rows = 0;
    };

    /// The places in the photograph, displaced as the band allows, where it differs least from the tile at
    /// the marked texels of the square: at most `count`, at least side / 8 apart, and at least side / 4 from
    /// where the tile itself shows it. The best first.
    std::vector<ExchangeAsset::Offset> best(std::int32_t x, std::int32_t y, std::int32_t side,
                                            const std::vector<std::uint8_t>& compared, const Band& band,
                                            std::size_t count) const;

  private:
    /// A rectangle of places in the photograph, for the square's first texel.
    struct Window {
        std::int32_t left = 0, top = 0, width = 0, height = 0;
    };
    Window everywhere(std::int32_t side) const;
    struct Reduced {
        std::int32_t width = 0, height = 0;
        std::vector<std::int16_t> lightness, green_red, blue_yellow;
    };
    struct TileTexel {
        std::int32_t x = 0, y = 0;
        PerceptualColor color;
    };
    std::vector<TileTexel> compared_texels(std::int32_t x, std::int32_t y, std::int32_t side,
                                           const std::vector<std::uint8_t>& compared,
                                           std::int32_t factor) const;
    bool shows_the_same(std::int32_t x, std::int32_t y, std::int32_t side,
                        const ExchangeAsset::Offset& at) const;

    const PerceptualImage& photo_;
    const QuiltedTile& tile_;
    std::int32_t margin_;
    std::map<std::int32_t, Reduced> photos_;  ///< By factor: 1, 2, 4 …
    std::map<std::int32_t, PerceptualImage> tiles_;
};

}  // namespace tessera
