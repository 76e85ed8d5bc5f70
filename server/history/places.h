#pragma once

#include <filesystem>
#include <string>

#include "shared/result/result.h"

namespace tessera {

/// Where a scene that people named on a command line is.
struct ScenePlaces {
    std::string id;
    std::filesystem::path scene;    ///< Its folder.
    std::filesystem::path journal;  ///< Of its edits; perhaps not there.
};

/// `scene` is a folder, or with `scenes` the name of one in there. `edits` is the folder that the server
/// keeps edits in; empty: where it does so by itself, beside the scenes or, for a scene served alone, inside
/// it. Errors: invalid_input, io_failure, naming option and fix.
Result<ScenePlaces> find_scene(const std::string& scene, const std::filesystem::path& scenes,
                               const std::filesystem::path& edits);

}  // namespace tessera
