#pragma once

#include <array>
#include <memory>
#include <vector>

#include "server/blocks/compilation.h"

namespace tessera {

/// Compiles what the cells of a reference texture show. `nodes` have their ops and are shared by all programs
/// of a plan; the roots are pattern, x, y, turn and scale; `types` is the number of the grid's types.
std::shared_ptr<const CellProgram> make_look_program(std::shared_ptr<const std::vector<CellNode>> nodes,
                                                     const std::array<std::size_t, 5>& roots,
                                                     const LookSteps& steps, std::uint32_t types);

}  // namespace tessera
