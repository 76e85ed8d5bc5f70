#pragma once

#include <cstdint>
#include <vector>

#include "server/texture/exchange_asset.h"
#include "shared/result/result.h"

namespace tessera {

/// The shape of a content that names none: the patch's part of the patch map, or, without one, all of its
/// box.
BitMask whole_shape(const ExchangeAsset& asset, std::size_t patch);

/// The shapes of all contents in one image, as an asset keeps them.
struct ShapeSheet {
    struct Place {
        std::int32_t x = 0, y = 0;
    };
    BitMask image;              ///< Empty if every content fills its patch: then no file is needed.
    std::vector<Place> places;  ///< Of each content's box, counted through all patches; empty with the image.
};

/// Packs them on shelves, the highest first. Error: invalid_input if they fill more than a PNG of ours may
/// hold.
Result<ShapeSheet> pack_shapes(const ExchangeAsset& asset);

/// The part of `sheet` that starts at (x, y), which lies inside it.
BitMask cut_shape(const BitMask& sheet, std::int32_t x, std::int32_t y, std::int32_t width,
                  std::int32_t height);

/// The most texels of a file of shapes, and of a side of it.
inline constexpr std::int64_t max_sheet_texels = std::int64_t{1} << 29;
inline constexpr std::int32_t max_sheet_side = 32768;

}  // namespace tessera
