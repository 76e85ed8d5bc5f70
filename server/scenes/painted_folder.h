#pragma once

#include <filesystem>
#include <functional>

#include "server/scenes/pattern_scenes.h"
#include "shared/result/result.h"

namespace tessera {

/// How a painted scene's folder stands.
enum class Standing {
    absent,    ///< Nothing there that loads.
    current,   ///< As this version paints it, or a person changed its scene file: theirs is kept.
    outdated,  ///< As an earlier version painted it.
};
Standing standing_of(const std::filesystem::path& folder);

/// Writes the scene's folder, whole or not at all, with a record of the version that painted it.
/// `add_ground` puts the folder that `on_pebbles` asks for inside; it may be empty if nothing does. Errors:
/// io_failure, invalid_input (a folder that is there and no scene).
Result<void> write_painted_folder(
    const std::filesystem::path& folder, const PaintedScene& painted,
    const std::function<Result<void>(const std::filesystem::path&)>& add_ground);

}  // namespace tessera
