#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/tile.h"
#include "server/progress/progress.h"
#include "server/texture/exchange_asset.h"
#include "shared/result/result.h"

namespace tessera {

/// What every preparation asks for; 0 of a number means the method's own default, chosen by the photograph's
/// size.
struct PrepareOptions {
    ExchangeMethod method = ExchangeMethod::content_exchange;
    std::int32_t tile_side =
        0;  ///< A power of two, 16 to 4096. Too small repeats; too large leaves no choice.
    std::int32_t patches =
        0;  ///< content_exchange: 16 to 256 of the tile. interchange: in the library, 16 to 4000.
    std::int32_t contents = 0;       ///< content_exchange: of each patch beside its own, 1 to 255.
    std::int32_t colors = 0;         ///< wang: of corners, 2 to 4: so many to the fourth tiles.
    std::int32_t blend_texels = -1;  ///< Even, 0 to 64; −1: the method's default.
    std::uint64_t seed = 1;          ///< Another seed, other patches.
    std::size_t threads = 0;         ///< 0: one for each processor. Changes nothing but the time.
    /// content_exchange: a hand-painted patch map, as large as the tile, any labels; empty: grown. Errors:
    /// holes (unconnected labels), too large boxes, name label and place.
    std::vector<std::uint16_t> patch_map = {};
};

/// An asset, and where its images come from, so that aligned images can be cut the same way.
struct PreparedAsset {
    ExchangeAsset asset;  ///< Without channels.
    std::vector<PhotoPoint>
        tile_sources;  ///< tile_side²: the photograph's texel that each of the tile's shows.
    std::vector<PhotoPoint>
        exemplar_sources;  ///< wang: of the exemplar's texels. Empty: the exemplar is the photograph.
};

/// Makes of a photograph what options.method needs. The same photograph, options and seed give the same asset
/// on every machine. What cannot be had as asked is made smaller, and noted to `progress`. `before`: an
/// earlier asset of the same photograph and options, whose pinned contents are kept and whose dropped ones
/// are not found again (they stay listed, dropped); null: start afresh. Errors: invalid_input (an option out
/// of range, a photograph too small), cancelled.
Result<PreparedAsset> prepare_exchange(const Rgb8Image& photo, const PrepareOptions& options,
                                       const ExchangeAsset* before, Progress& progress);

// The methods, one file each; options as asked for, checked by each.
Result<PreparedAsset> prepare_content_exchange(const Rgb8Image& photo, const PrepareOptions& options,
                                               const ExchangeAsset* before, Progress& progress);
Result<PreparedAsset> prepare_interchange(const Rgb8Image& photo, const PrepareOptions& options,
                                          const ExchangeAsset* before, Progress& progress);
Result<PreparedAsset> prepare_wang(const Rgb8Image& photo, const PrepareOptions& options,
                                   const ExchangeAsset* before, Progress& progress);

}  // namespace tessera
