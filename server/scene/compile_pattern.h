#pragma once

#include <filesystem>
#include <span>

#include "shared/motion/targets.h"
#include "shared/result/result.h"

namespace tessera {

struct Plan;
struct PatternKept;
struct Scene;
class BlockFiles;
namespace proto {
class Pattern;
}

/// The most that the blocks of one scene may take in memory.
inline constexpr std::size_t max_pattern_bytes = std::size_t{3} << 30;

/// Compiles the blocks of the scene file `file`, which look at `targets`: sets scene.texture,
/// scene.slices, scene.animated, scene.clocked, scene.parameters and scene.block_list. Errors: invalid_input,
/// io_failure; the message starts with file and field.
/// `kept`: as of make_pattern_texture().
Result<void> compile_pattern(BlockFiles& files, PatternKept* kept, const std::filesystem::path& file,
                             const proto::Pattern& message, std::span<const MovingTarget> targets,
                             Scene& scene);

/// Its decisions, checked and found affordable. Errors: as above, starting with the field.
Result<Plan> plan_pattern(const proto::Pattern& message, BlockFiles& files);

}  // namespace tessera
