#pragma once

#include <cstdint>
#include <vector>

namespace tessera {

/// The paper's own random numbers (3.2, Virtual Indirection Map): a table σ of T indices, shuffled once, and
/// the series s0 = σ(g), s_i = σ(⌊g / T^i⌋ + s_(i−1)), unrolled to three steps as the paper does "in
/// practice"; all indices modulo T. In two dimensions, as the paper has it from Perlin, σ(x + σ(y)): the
/// series over x starts from the series over y. Kept for comparison: README.md says where it degenerates.
class SigmaSeries {
  public:
    SigmaSeries(std::uint64_t seed, std::uint64_t key, std::uint32_t count);
    /// Below count.
    std::int32_t at(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept;
    std::size_t memory_bytes() const noexcept { return sigma_.size() * sizeof sigma_[0]; }

  private:
    std::uint32_t along(std::int64_t g, std::uint32_t start) const noexcept;

    std::vector<std::uint32_t> sigma_;
};

}  // namespace tessera
