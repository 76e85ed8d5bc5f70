#pragma once

#include <cstdint>

namespace tessera {

/// The random map of DESIGN section 2, "Nested thresholds": 16 digits of base 4, the most significant first,
/// d_j = π[hash(seed, stream, j, node_j, d_1 … d_(j−1))](q_j). Every aligned 2^j × 2^j block of cells, j up
/// to 16, holds exactly one threshold in each of the 4^j strata of [0, 2^32).
class NestedThresholds {
  public:
    /// `base`: of the stream; `z`: the layer of cells.
    NestedThresholds(std::uint64_t base, std::int64_t z) noexcept;
    /// Of cells (x, y), (x + 1, y), …: at most stretch_cells + max_reach. Digits behind the first `digits` (1
    /// to 16) are 0. Fast for rows that follow each other.
    void row(std::int64_t x, std::int64_t y, std::int32_t cells, std::uint32_t* out, int digits = 16) const;

  private:
    std::uint64_t base_;
};

}  // namespace tessera
