#pragma once

#include <filesystem>
#include <string>

#include "shared/result/result.h"

namespace tessera {

/// The path that `field` of a scene file names, kept inside the scene's folder, also through symbolic links.
/// `what` it is stands in messages: "asset", "image". Error: invalid_input, which starts with the field.
Result<std::filesystem::path> path_inside(const std::filesystem::path& folder, const std::string& field,
                                          const std::string& name, const std::string& what);

}  // namespace tessera
