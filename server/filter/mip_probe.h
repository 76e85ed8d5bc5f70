#pragma once

#include <cstdint>

#include "server/filter/four.h"
#include "server/filter/lattice.h"
#include "server/filter/page_tables.h"

namespace tessera {

/// Points of the MIP pyramid, interpolated as GPUs do it. For one thread.
class MipProbe {
  public:
    MipProbe(std::shared_ptr<const TexelPages> pages, std::size_t memory_bytes)
        : texels_{std::move(pages), memory_bytes} {}

    /// Between the four nearest texel centres of a level.
    Floats4 bilinear(int level, const LatticePoint& at, Reading& reading);

    /// Between two levels, `lod` = log2 of the texels of level 0 that a sample stands for (Williams,
    /// "Pyramidal parametrics", SIGGRAPH 1983). Below 0: bilinear on level 0.
    Floats4 trilinear(double lod, const LatticePoint& at, Reading& reading);

    /// What the last bilinear() of level 0 can be wrong by, in codes: where the four texels cover the
    /// footprint, the truth lies between them.
    double bound_of_four(const Footprint& footprint, const Doubles4& steps) const noexcept;

  private:
    PageTables<TexelRows> texels_;
    std::int64_t first_x_ = 0, first_y_ = 0;  ///< Of the last four texels.
    Floats4 least_{}, most_{};
};

/// log2 of a normal number above 0, within 10^−9, by + − × ÷ only.
double log2_of(double v) noexcept;

}  // namespace tessera
