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

    /// A rectangle of places in the photograph, for the square's first texel.
    struct Window {
        std::int32_t left = 0, top = 0, width = 0, height = 0;
    };
    /// All places of a square.
    Window everywhere(std::int32_t side) const;

    /// The places in `window` where the photograph differs least from the tile on the ring that a patch's
    /// border keeps to, at most `count`, at least side / 8 apart, and at least side / 4 from where the tile
    /// itself shows it. The best first. Texels of the tile marked in `taken` (its side², or empty) do not
    /// count.
    std::vector<ExchangeAsset::Offset> best(std::int32_t x, std::int32_t y, std::int32_t side,
                                            const std::vector<std::uint8_t>& taken, const Window& window,
                                            std::size_t count) const;

  private:
    struct Reduced {
        std::int32_t width = 0, height = 0;
        std::vector<std::int16_t> lightness, green_red, blue_yellow;
    };
    struct RingTexel {
        std::int32_t x = 0, y = 0;
        PerceptualColor color;
    };
    std::vector<RingTexel> ring(std::int32_t x, std::int32_t y, std::int32_t side,
                                const std::vector<std::uint8_t>& taken, std::int32_t factor) const;
    bool shows_the_same(std::int32_t x, std::int32_t y, std::int32_t side,
                        const ExchangeAsset::Offset& at) const;

    const PerceptualImage& photo_;
    const QuiltedTile& tile_;
    std::int32_t margin_;
    std::map<std::int32_t, Reduced> photos_;  ///< By factor: 1, 2, 4 …
    std::map<std::int32_t, PerceptualImage> tiles_;
};

}  // namespace tessera
