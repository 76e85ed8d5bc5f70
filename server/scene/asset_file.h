#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/texture/exchange_asset.h"
#include "shared/result/result.h"

namespace tessera {

/// What an asset's preparation was asked for: recorded, so that it can go on, and so that what is outdated
/// can be told. 0, and −1 of blend_texels: the method's own.
struct Preparation {
    ExchangeMethod method = ExchangeMethod::content_exchange;  ///< The asset's.
    std::uint32_t version = 0;                                 ///< Of the way of preparing; 0: not known.
    std::string photo;                                         ///< photo_id(); empty: not known.
    std::uint64_t seed = 0;
    std::int32_t tile_side = 0, patches = 0, contents = 0, colors = 0, blend_texels = -1;
    bool painted_patch_map = false;  ///< The patch map is a person's.
};

/// 16 hex digits that name the photograph's texels, whatever file they are in.
std::string photo_id(const Rgb8Image& photo);

/// Reads the folder that `tessera prepare` made (proto/asset.proto) and checks everything in it: sizes,
/// labels, boxes, shapes, offsets inside the exemplar, files inside the folder. Errors: invalid_input,
/// io_failure; the message names file, field and fix.
Result<ExchangeAsset> read_exchange_asset(const std::filesystem::path& folder);

/// The same folder's record of how it was made; its images are not looked at.
Result<Preparation> read_preparation(const std::filesystem::path& folder);

/// Whether an asset may be written there, asked before the long work: the place is free or holds an asset and
/// nothing else, and its parent is a folder.
Result<void> check_asset_target(const std::filesystem::path& folder);

/// Writes the folder whole or not at all: a neighbour that is renamed into place. A content without a shape
/// fills its patch. Errors: io_failure, invalid_input.
Result<void> write_exchange_asset(const std::filesystem::path& folder, const ExchangeAsset& asset,
                                  const Preparation& preparation);

/// What a person says of a content, by the numbers that reports show.
struct StandingChange {
    std::uint64_t patch = 0;
    std::optional<std::uint64_t>
        content;  ///< From 1 on in the order listed; 0 is the tile's own. Unset: all.
    ExchangeAsset::Standing standing = ExchangeAsset::Standing::chosen;
};

/// Changes `asset`, which was read from `folder`. Error: invalid_input (a number out of range, an asset that
/// would be none afterwards), which names file, number and fix.
Result<void> apply_standings(ExchangeAsset& asset, const std::filesystem::path& folder,
                             const std::vector<StandingChange>& changes);

/// Writes them into the folder's asset.json and changes nothing else; all of them, or none. Errors: as above,
/// and io_failure.
Result<void> change_standings(const std::filesystem::path& folder,
                              const std::vector<StandingChange>& changes);

}  // namespace tessera
