#pragma once

#include <memory>
#include <vector>

#include "server/compare/own_seams.h"
#include "server/prepare/prepare.h"
#include "server/progress/terminal_progress.h"
#include "server/quality/measures.h"

namespace tessera {

/// A preparation with what came of it.
struct JudgedAsset {
    ExchangeAsset asset;
    std::shared_ptr<const ExchangeTexture> texture;  ///< Blended.
    Quality quality;
    OwnSeams own_seams;  ///< Of the tile; for wang of all tiles.
    double prepare_seconds = 0;
    double measure_seconds = 0;
};

/// Prepares and measures. Errors: those of prepare_exchange(), cancelled.
Result<JudgedAsset> judge(const Rgb8Image& photo, const PrepareOptions& options, Progress& progress);

/// Its stages for a progress bar.
std::vector<TerminalProgress::Share> judge_shares(ExchangeMethod method);

}  // namespace tessera
