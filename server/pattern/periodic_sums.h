#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/blocks/cell_program.h"
#include "server/pattern/area_sums.h"
#include "server/pattern/pattern_mips.h"

namespace tessera {

/// Means over squares of cells that come again after a period, with few different rows: the paper's
/// permutation series above all. Running sums of each different row, and how often each occurs among the
/// rows.
class PeriodicSums {
  public:
    static constexpr std::int64_t most_period = 4096;
    /// Of all different rows together.
    static constexpr std::size_t most_cells = std::size_t{1} << 18;
    static constexpr std::size_t most_bytes = most_cells * 36;

    /// `program` has a period of at most most_period. Null where too many rows differ.
    static std::shared_ptr<const PeriodicSums> make(const CellProgram& program, const PatternMips& mips,
                                                    std::int32_t slice, std::int64_t z);

    /// The mean over the 2^up × 2^up cells of texel (x, y), any up from 0 on. Exact but for rounding.
    Colour mean(std::int64_t x, std::int64_t y, int up) const noexcept;
    /// What a mean costs, in look-ups.
    std::size_t rows() const noexcept { return sums_.size(); }

  private:
    explicit PeriodicSums(int period_log2) : period_log2_{period_log2} {}

    int period_log2_;
    double unit_ = 1;
    std::vector<std::vector<std::array<std::int64_t, 4>>> sums_;  ///< [different row][cells from 0 on]
    std::vector<std::vector<std::int32_t>> counts_;               ///< [different row][rows from 0 on]
};

}  // namespace tessera
