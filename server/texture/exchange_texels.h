#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "server/texture/edge_codes.h"
#include "server/texture/exchange_layout.h"
#include "server/texture/stamps.h"
#include "server/texture/texel_source.h"
#include "server/texture/unit_sums.h"

namespace tessera {

/// One image under a layout, in the forms that the levels are made of: the colour, or three channels of data.
struct ExchangeTexels {
    TexelSource exemplar;
    TexelSource tile;  ///< Repeated to the right as far as the widest box.
    EdgeCodes edges;   ///< Where the images have codes.
    TileLevels tile_levels;
    Stamps stamps;
    std::vector<VariantImages> images;  ///< choice: typed: of the levels up to the unit's, finest first.
    std::optional<NodeTables> nodes;    ///< choice: typed
    std::optional<IndependentSums> independent_sums;
    double expectation[3] = {};  ///< choice: kolar: the mean of many tiles.

    ExchangeTexels(const ExchangeLayout& layout, TexelSource exemplar_image, const TexelSource& tile_image);
    std::size_t memory_bytes() const noexcept;
};

/// What the images of variants may take: beyond, levels are summed stamp by stamp.
inline constexpr std::size_t max_image_bytes = std::size_t{40} << 20;

}  // namespace tessera
