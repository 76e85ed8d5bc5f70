#pragma once

#include <filesystem>

#include "shared/result/result.h"

namespace tessera {

struct Scene;
namespace proto {
class Pattern;
}

/// The most that the blocks of one scene may take in memory.
inline constexpr std::size_t max_pattern_bytes = std::size_t{3} << 30;

/// Compiles the blocks of the scene file `file` of `folder`: sets scene.texture, scene.slices, scene.animated
/// and scene.block_list. Errors: invalid_input, io_failure; the message starts with file and field.
Result<void> compile_pattern(const std::filesystem::path& folder, const std::filesystem::path& file,
                             const proto::Pattern& message, Scene& scene);

}  // namespace tessera
