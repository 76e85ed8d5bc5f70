#pragma once

#include "server/blocks/compilation.h"

namespace tessera {

/// The node of a draw below `count`. Its generator is chosen when all blocks are known (choose_generators),
/// and so is its op. Error: no such generator.
Result<CellNode> make_draw(Compilation& c, std::size_t block, std::size_t grid, Generator generator,
                           std::uint32_t stream, std::uint32_t count);

/// Decides who draws, for every draw: `automatic` is typed where all reference textures that show it have
/// looks that do not vary over the plane and no other generator, else independent. Then makes their ops and
/// the quadtrees of their grids. Errors: `typed` where looks vary; too many grids with types.
Result<void> choose_generators(Compilation& c);

}  // namespace tessera
