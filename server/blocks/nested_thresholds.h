#pragma once

#include <cstdint>

namespace tessera {

/// The random map of DESIGN section 2, "Nested thresholds": 16 digits of base 4, the most significant first.
/// Every aligned 2^j × 2^j block of cells, j up to 16, holds exactly one threshold in each of the 4^j strata
/// of [0, 2^32).
class NestedThresholds {
  public:
    /// `base`: of the stream; `z`: the layer of cells.
    NestedThresholds(std::uint64_t base, std::int64_t z) noexcept;
    std::uint32_t at(std::int64_t x, std::int64_t y) const noexcept;

  private:
    std::uint64_t base_;
};

}  // namespace tessera
