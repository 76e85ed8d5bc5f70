#pragma once

#include <memory>

#include "server/blocks/cell_node.h"

namespace tessera {

/// `independent`: a counter hash of the cell. The draw's base is known.
std::shared_ptr<const CellOp> make_independent_op(const CellDraw& draw);

/// `nested`: thresholds of DESIGN section 2, ⌊r·count⌋.
std::shared_ptr<const CellOp> make_nested_op(std::uint64_t seed, const CellDraw& draw);

/// `sigma`: the paper's permutation series, for comparison.
std::shared_ptr<const CellOp> make_sigma_op(std::uint64_t seed, const CellDraw& draw);

/// `typed`: the draw of each type, every alternative equally often over the types, to within one. Draws of
/// one key are of one shuffle.
std::shared_ptr<const CellOp> make_typed_op(std::uint64_t seed, const CellDraw& draw);

}  // namespace tessera
