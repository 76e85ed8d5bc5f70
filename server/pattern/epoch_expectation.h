#pragma once

#include <cstdint>
#include <memory>

#include "server/blocks/cell_program.h"
#include "server/pattern/area_expectation.h"
#include "server/pattern/look_means.h"
#include "server/pattern/slice_cache.h"

namespace tessera {

/// What texels of many cells are expected to show, by slice and, where looks move, by step: their average
/// over time where that is within half a code of what is expected at any step, and so static; else what is
/// expected at the step.
class EpochExpectation {
  public:
    /// `width`: of the colours that cells may show. `means` lives as long.
    EpochExpectation(std::shared_ptr<const CellProgram> program, const LookMeans& means, double width);

    /// Whether looks can be listed; if not, nothing else may be called.
    bool known() const noexcept { return known_; }
    /// Whether nothing is drawn by chance and nothing moves: the expectation is what is shown.
    bool certain() const noexcept { return certain_; }
    bool uniform() const { return known_ && of_slice(0)->is->uniform(); }

    /// As AreaExpectation::evaluate, of a slice of the pattern set.
    Result<Evaluation> evaluate(const TexelRegion& region, std::int64_t slice, int up, const Budget& budget,
                                LinearImage& out) const;
    /// As AreaExpectation::bound, of the first slice, at rest.
    ChanceBound bound(int up) const { return of_slice(0)->is->bound(up); }
    std::size_t memory_bytes() const;

  private:
    struct Kept {
        std::unique_ptr<const CellProgram> program;  ///< What `is` was made of, if it is an epoch's.
        std::unique_ptr<const AreaExpectation> is;
    };
    std::shared_ptr<const Kept> of_slice(std::int64_t slice) const;
    std::shared_ptr<const Kept> of_epoch(std::int64_t slice, const Epoch& epoch) const;

    std::shared_ptr<const CellProgram> program_;
    const LookMeans& means_;
    double width_;
    SliceCache<Kept> kept_;
    bool known_ = false, certain_ = false;
};

}  // namespace tessera
