#pragma once

#include <filesystem>

#include "shared/result/result.h"

namespace tessera {

struct PatternKept;
struct Scene;
class BlockFiles;
namespace proto {
class Scene;
}

/// Compiles what the scene file `file` of `folder`, read into `message`, says of the texture: sets
/// scene.texture, scene.channels and what else follows from it. Errors: invalid_input, io_failure; the
/// message names file, field and fix.
Result<void> compile_scene(const std::filesystem::path& folder, const std::filesystem::path& file,
                           const proto::Scene& message, Scene& scene);

/// The same without the sprites, from `files`. `kept`: as of make_pattern_texture().
Result<void> compile_ground(const std::filesystem::path& folder, const std::filesystem::path& file,
                            const proto::Scene& message, BlockFiles& files, PatternKept* kept, Scene& scene);

}  // namespace tessera
