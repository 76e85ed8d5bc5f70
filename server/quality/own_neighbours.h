#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/exchange_asset.h"

namespace tessera {

/// What would lie beside a texel if its source went on there: the tile, or a place of the exemplar.
class OwnNeighbours {
  public:
    /// `asset` outlives it.
    explicit OwnNeighbours(const ExchangeAsset& asset);

    /// `source` is what ExchangeTexture::sources() says of the texel (x, y) of level 0, and `shown` its three
    /// codes there, unblended. Three codes; null where the source ends, or does not show `shown` there.
    const std::uint8_t* beside(std::uint32_t source, std::int64_t x, std::int64_t y, std::int32_t dx,
                               std::int32_t dy, const std::uint8_t* shown) const;

  private:
    struct Shown {
        std::size_t patch = 0, content = 0;
    };

    const ExchangeAsset& asset_;
    std::vector<Shown> shown_;  ///< By the numbers of sources() − 1.
};

}  // namespace tessera
