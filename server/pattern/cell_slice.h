#pragma once

#include <cstdint>

#include "server/blocks/plan.h"

namespace tessera {

/// Where a slice of the texture is: the layer of cells, and the slice inside it.
struct CellSlice {
    std::int64_t z = 0;
    std::int64_t slice = 0;
};

/// `slices`: of the pattern set; it repeats where the grid's cells are not 3D.
inline CellSlice cell_slice(const Grid& grid, std::int64_t slice, std::int32_t slices) noexcept {
    if (grid.cell_slices == 0) return {0, (slice % slices + slices) % slices};
    const std::int64_t z = grid.cell_z(slice);
    return {z, slice - z * grid.cell_slices};
}

}  // namespace tessera
