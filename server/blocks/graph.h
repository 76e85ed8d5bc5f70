#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "proto/pattern.pb.h"

#include "shared/result/result.h"

namespace tessera {

inline constexpr std::size_t max_blocks = 4096;
inline constexpr std::size_t no_block = static_cast<std::size_t>(-1);

/// What a block gives.
enum class Output : std::uint8_t { patterns, grid, integer, number, sequence, transform, texture };

/// A field that names another block.
struct BlockReference {
    std::string field;  ///< ".index", ".textures[2]": behind the block's path.
    std::string name;
    std::uint32_t allowed = 0;  ///< Bits 1 << Output.
    std::size_t block = no_block;
};

struct GraphBlock {
    const proto::Block* message = nullptr;
    std::string path;       ///< pattern.blocks[3] "areas"
    std::string_view kind;  ///< "areas_map"
    Output output{};
    std::vector<BlockReference> references;
    bool reached = false;
};

/// The blocks of a scene file, names resolved.
struct Graph {
    std::vector<GraphBlock> blocks;
    std::vector<std::size_t> order;      ///< Those that reach the output, parts before wholes.
    std::vector<std::size_t> unreached;  ///< All others, parts before wholes.
    std::size_t output = no_block;

    std::size_t find(std::string_view name) const;                  ///< no_block if there is none.
    std::vector<std::pair<std::string_view, std::size_t>> by_name;  ///< Sorted.
};

/// Checks names, references, their types, and that nothing goes round, of all blocks; no other field.
/// Nothing here recurses: chains may be as long as there are blocks.
Result<Graph> check_graph(const proto::Pattern& message);

}  // namespace tessera
