#pragma once

#include <array>
#include <memory>
#include <vector>

#include "server/blocks/compilation.h"

namespace tessera {

/// Compiles what the cells of a reference texture show. `nodes` have their ops and are shared by all programs
/// of a plan; the roots are pattern, x, y, turn and scale; `types` is the number of the grid's types.
/// `cell_log2`: of the grid. `scroll`: of its cells.
std::shared_ptr<const CellProgram> make_look_program(std::shared_ptr<const std::vector<CellNode>> nodes,
                                                     const std::array<std::size_t, 5>& roots,
                                                     const LookSteps& steps, std::uint32_t types,
                                                     int cell_log2, const Scroll& scroll);

}  // namespace tessera
