#pragma once

#include <filesystem>

#include "shared/result/result.h"

namespace tessera {

struct Scene;
namespace proto {
class Sprites;
}

/// Puts the sprites of the scene file `file` of `folder` over scene.texture, which is set. Errors:
/// invalid_input, io_failure; the message names file, sprite, field and fix.
Result<void> compile_sprites(const std::filesystem::path& folder, const std::filesystem::path& file,
                             const proto::Sprites& message, Scene& scene);

}  // namespace tessera
