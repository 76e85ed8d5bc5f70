#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/texture/exemplar_texels.h"
#include "server/texture/kernels.h"
#include "server/texture/patch_map.h"

namespace tessera {

/// Level 0 of content exchange: where one patch covers a texel the exemplar's codes are copied, bit for bit;
/// where blending patches meet, their linear steps are summed with integer weights. Each tile row is cut into
/// runs with the same patches, once, when the scene loads.
class Level0 {
  public:
    struct Term {
        std::uint16_t patch = 0;
        std::uint8_t left = 0;      ///< 1: the patch hangs over from the tile to the left.
        std::uint8_t above = 0;     ///< 1: from the tile above.
        std::int32_t x = 0, y = 0;  ///< The run's first texel relative to the patch's origin.
        std::uint32_t weights =
            0;  ///< Of the run's first texel in weights(); unused where the run has one term.
    };
    struct Run {
        std::int32_t begin = 0, end = 0;  ///< Columns of the tile.
        std::uint32_t first_term = 0;
        std::uint32_t terms = 0;
    };

    explicit Level0(const PatchMap& map);

    /// The runs of a row of the tile, which cover it from left to right.
    std::span<const Run> row(std::int32_t y) const noexcept {
        return {runs_.data() + row_begin_[std::size_t(y)], runs_.data() + row_begin_[std::size_t(y) + 1]};
    }
    const Term* terms(const Run& run) const noexcept { return terms_.data() + run.first_term; }
    const std::uint16_t* weights(const Term& term) const noexcept { return weights_.data() + term.weights; }

    std::size_t memory_bytes() const noexcept {
        return row_begin_.size() * sizeof(std::uint32_t) + runs_.size() * sizeof(Run) +
               terms_.size() * sizeof(Term) + weights_.size() * sizeof(std::uint16_t);
    }

  private:
    void cut_row(const PatchMap& map, std::int32_t y);

    std::vector<std::uint32_t> row_begin_;
    std::vector<Run> runs_;
    std::vector<Term> terms_;
    std::vector<std::uint16_t>
        weights_;  ///< Four equal ones for each texel of a term, padded to whole blocks.
};

}  // namespace tessera
