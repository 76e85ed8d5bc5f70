#pragma once

#include <filesystem>

#include "shared/result/result.h"

namespace tessera {

struct Scene;
namespace proto {
class Scene;
}

/// Compiles what the scene file `file` of `folder`, read into `message`, says of the texture: sets
/// scene.texture, scene.channels and what else follows from it. Errors: invalid_input, io_failure; the
/// message names file, field and fix.
Result<void> compile_scene(const std::filesystem::path& folder, const std::filesystem::path& file,
                           const proto::Scene& message, Scene& scene);

}  // namespace tessera
