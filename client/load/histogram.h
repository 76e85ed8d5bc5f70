#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

/// Counts durations in buckets that are linear within each power of two, in the manner of HdrHistogram (Gil
/// Tene): 128 buckets an octave from 1 ns up to 2^63 ns, so that memory is constant (59 KB) and every value
/// that comes out is within 1/256 (0.4 %) of the one that went in; below 256 ns it is exact. Minimum, maximum
/// and mean are exact.
class LatencyHistogram {
  public:
    static constexpr unsigned bits = 7;                    ///< log2 of the buckets in an octave.
    static constexpr double relative_error = 1.0 / 256.0;  ///< Half a bucket's width over its lower end.

    LatencyHistogram();

    /// A negative duration counts as 0.
    void record(std::chrono::nanoseconds duration, std::uint64_t times = 1);
    /// As if all that `other` recorded had been recorded here.
    void merge(const LatencyHistogram& other);
    void clear();

    std::uint64_t count() const noexcept { return count_; }
    /// 0 if nothing was recorded; so are the next three.
    std::chrono::nanoseconds min() const noexcept;
    std::chrono::nanoseconds max() const noexcept;
    std::chrono::nanoseconds mean() const noexcept;
    /// The smallest recorded duration that at least `percent` (0 to 100) of all do not exceed.
    std::chrono::nanoseconds percentile(double percent) const;

    struct Bucket {
        std::uint64_t lowest = 0;   ///< ns
        std::uint64_t highest = 0;  ///< ns, inclusive
        std::uint64_t count = 0;
    };
    /// The buckets that hold something, ascending. Runs are merged by adding counts of equal buckets.
    std::vector<Bucket> filled() const;

  private:
    static std::size_t index_of(std::uint64_t value) noexcept;
    static std::uint64_t lowest_of(std::size_t index) noexcept;

    std::vector<std::uint64_t> counts_;
    std::uint64_t count_ = 0;
    std::uint64_t min_ = 0;
    std::uint64_t max_ = 0;
    double sum_ = 0;
};

}  // namespace tessera
