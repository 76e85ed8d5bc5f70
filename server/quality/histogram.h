#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

/// How often values occur, in bins of a sixteenth of a unit of CIELAB from `lowest` on. Values beyond count
/// at the ends.
class Histogram {
  public:
    static constexpr float bins_per_unit = 16;

    Histogram(float lowest, float highest)
        : lowest_{lowest}, counts_(static_cast<std::size_t>((highest - lowest) * bins_per_unit) + 1) {}

    void add(float value) noexcept {
        const float bin = std::clamp((value - lowest_) * bins_per_unit, 0.0F, float(counts_.size() - 1));
        ++counts_[static_cast<std::size_t>(bin)];
        ++count_;
        sum_ += double(value);
    }

    std::uint64_t count() const noexcept { return count_; }
    double mean() const noexcept { return count_ == 0 ? 0 : sum_ / double(count_); }
    float lowest() const noexcept { return lowest_; }
    const std::vector<std::uint64_t>& counts() const noexcept { return counts_; }

    /// The value below which `share` (0 to 1) of all lie.
    double percentile(double share) const noexcept;

  private:
    float lowest_;
    std::vector<std::uint64_t> counts_;
    std::uint64_t count_ = 0;
    double sum_ = 0;
};

/// The earth mover's distance of two histograms with the same bins: how far, on average, values have to move
/// to turn one into the other. 0 if one of them is empty.
double distance(const Histogram& a, const Histogram& b) noexcept;

}  // namespace tessera
