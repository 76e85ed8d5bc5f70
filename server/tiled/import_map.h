#pragma once

#include <filesystem>
#include <string>

#include "server/tiled/tiled_scene.h"

namespace tessera {

/// Makes the scene folder `folder` of a map of the Tiled editor, whole or not at all; a scene that was there
/// is replaced. Beside the scene file lies import.txt, the scene's report. `title`: for people; empty means
/// the map's name. Stages: reading, painting, writing, checking. Errors: invalid_input, io_failure,
/// cancelled; the message names the file and the fix.
Result<TiledScene> import_tiled_map(const std::filesystem::path& map, const std::filesystem::path& folder,
                                    const std::string& title, Progress& progress);

}  // namespace tessera
