#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/prepare/prepare.h"
#include "server/progress/terminal_progress.h"
#include "server/scene/asset_file.h"

namespace tessera {

/// Raise it whenever the same photograph and options give another asset: assets of another version are made
/// again where that needs nobody's consent.
inline constexpr std::uint32_t prepare_version = 9;

/// A further image of the photograph's surface, as large as the photograph: "normal", "roughness" or
/// "height".
struct AlignedImage {
    std::string name;
    Rgb8Image image;
};

/// An asset with its channels, and the record of how it was made.
struct RecordedAsset {
    ExchangeAsset asset;
    Preparation preparation;
};

/// prepare_exchange(), and the aligned images cut the same way. `before`, if any, is an asset of the same
/// options. Errors: as there, and invalid_input for an aligned image of another size.
Result<RecordedAsset> prepare_recorded(const Rgb8Image& photo, const std::vector<AlignedImage>& aligned,
                                       const PrepareOptions& options, const ExchangeAsset* before,
                                       Progress& progress);

/// Where preparation goes on from.
struct Earlier {
    ExchangeAsset asset;
    PrepareOptions options;             ///< What it was prepared with.
    std::uint32_t version = 0;          ///< Of the preparation; see prepare_version.
    std::vector<AlignedImage> aligned;  ///< As they were given, where the asset still holds them whole.
    std::vector<std::string> cut_up;    ///< Names of those that it holds in pieces only.

    /// Whether a person pinned or dropped any content.
    bool is_judged() const;
};

/// Reads the asset in `folder`. Errors: those of reading, and invalid_input if it was not made of this
/// photograph.
Result<Earlier> read_earlier(const std::filesystem::path& folder, const Rgb8Image& photo);

/// The method's stages and what each takes of the time, as a progress bar wants them.
std::vector<TerminalProgress::Share> prepare_shares(ExchangeMethod method);

}  // namespace tessera
