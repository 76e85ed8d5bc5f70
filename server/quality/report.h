#pragma once

#include <filesystem>

#include "server/progress/progress.h"
#include "server/quality/measures.h"
#include "server/texture/exchange.h"
#include "shared/result/result.h"

namespace tessera {

/// Writes what a person needs to judge `asset`: tile, patch map, contents with the numbers that `--drop` and
/// `--keep` take, where seams are costly, previews, and the measured figures with their gates. `html` is one
/// file that works offline; beside it the figures again for programs, under the same name ending in .json.
/// Both whole or not at all. Takes some seconds; stages: "measuring", "drawing". Errors: io_failure,
/// invalid_input, which name the file; cancelled.
Result<void> write_report(const std::filesystem::path& html, const ExchangeAsset& asset, Progress& progress);

/// The same for textures that are compiled already.
Result<void> write_report(const std::filesystem::path& html, const ExchangeAsset& asset,
                          const MeasuredTextures& textures, Progress& progress);

/// Whether a report may be written there, asked before the long work: the name ends in .html or .htm, and its
/// parent is a folder.
Result<void> check_report_target(const std::filesystem::path& html);

}  // namespace tessera
