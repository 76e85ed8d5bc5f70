#pragma once

#include <memory>

#include "server/blocks/plan.h"
#include "server/pattern/pattern_mips.h"
#include "server/pattern/pattern_texture.h"

namespace tessera {

/// A texture whose cells are each filled by a pattern: `plan` is without a transform, and its patterns' side
/// is the cell's. Levels up to the cell are copies of rows of the patterns' MIP chains. Above it: typed cells
/// from tables; others cell by cell while that is affordable, then by their expectation with its bound
/// (area_expectation.h). Which of the two depends on level and accuracy alone, so that any split of a region
/// gives the same texels.
/// `mips`: of the plan's patterns; null: they are made.
std::shared_ptr<const PatternTexture> make_cell_texture(const ReferencePlan& plan,
                                                        std::shared_ptr<const PatternMips> mips = nullptr);

}  // namespace tessera
