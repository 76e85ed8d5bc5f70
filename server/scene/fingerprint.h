#pragma once

#include <filesystem>
#include <string>

#include "shared/result/result.h"

namespace tessera {

/// 16 hex digits over every file of the folder that is not hidden, by relative name and content, and the
/// versions of evaluator and encoders. Of the scene file it takes `scene_text`, which was parsed, and not
/// what the file may hold by now. Error: io_failure, which names the file.
Result<std::string> fingerprint_of(const std::filesystem::path& folder, const std::string& scene_text);

}  // namespace tessera
