#pragma once

#include <filesystem>

#include "server/texture/exchange.h"
#include "shared/result/result.h"

namespace tessera {

/// Reads the folder that `tessera prepare` made (proto/asset.proto) and checks everything in it: sizes,
/// labels, boxes that enclose their patches, offsets inside the exemplar, files inside the folder. Errors:
/// invalid_input, io_failure; the message names file, field and fix.
Result<ExchangeAsset> read_exchange_asset(const std::filesystem::path& folder);

/// Whether an asset may be written there, asked before the long work: the place is free or holds an asset and
/// nothing else, and its parent is a folder.
Result<void> check_asset_target(const std::filesystem::path& folder);

/// Writes the folder whole or not at all: a neighbour that is renamed into place. `seed` is recorded.
Result<void> write_exchange_asset(const std::filesystem::path& folder,
                                          const ExchangeAsset& asset, std::uint64_t seed);

}  // namespace tessera
