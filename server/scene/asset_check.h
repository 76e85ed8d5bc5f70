#pragma once

#include <cstdint>
#include <filesystem>

#include "server/texture/exchange_asset.h"
#include "shared/result/result.h"

namespace tessera {

/// More than any asset's JSON needs: its patches and contents are at most 65535.
inline constexpr std::int64_t max_asset_json_bytes = std::int64_t{1} << 26;

/// The files that an asset's parts were read from, for messages.
struct AssetFiles {
    std::filesystem::path json, exemplar, tile, patches, shapes;
};

/// Holds an asset, each of whose numbers is in its range and whose images have their sizes, against what its
/// method promises: labels and boxes agree; shapes keep to their regions; no two of what may be shown
/// together overlap; no tile is missing. Errors: invalid_input, which names file, field and fix.
Result<void> check_exchange_asset(const ExchangeAsset& asset, const AssetFiles& files);

}  // namespace tessera
