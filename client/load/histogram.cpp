#include "client/load/histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tessera {

using std::chrono::nanoseconds;

namespace {
constexpr std::uint64_t per_octave = std::uint64_t{1} << LatencyHistogram::bits;
// Values below 2^(bits+1) have a bucket each; each further octave up to bit 62 has per_octave buckets
constexpr std::size_t buckets = (64 - LatencyHistogram::bits) * per_octave;

nanoseconds as_duration(std::uint64_t value) { return nanoseconds{static_cast<std::int64_t>(value)}; }
}  // namespace

LatencyHistogram::LatencyHistogram() : counts_(buckets) {}

std::size_t LatencyHistogram::index_of(std::uint64_t value) noexcept {
    if (value < 2 * per_octave) return static_cast<std::size_t>(value);
    // Drop the low bits until `bits` + 1 are left: the leading one names the octave, the rest the bucket in
    // it
    const unsigned dropped = static_cast<unsigned>(std::bit_width(value)) - (bits + 1);
    return static_cast<std::size_t>(dropped * per_octave + (value >> dropped));
}

std::uint64_t LatencyHistogram::lowest_of(std::size_t index) noexcept {
    if (index < 2 * per_octave) return index;
    const unsigned dropped = static_cast<unsigned>(index / per_octave) - 1;
    return (index - dropped * per_octave) << dropped;
}

void LatencyHistogram::record(nanoseconds duration, std::uint64_t times) {
    if (times == 0) return;
    const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(0, duration.count()));
    counts_[index_of(value)] += times;
    min_ = count_ == 0 ? value : std::min(min_, value);
    max_ = std::max(max_, value);
    count_ += times;
    sum_ += static_cast<double>(value) * static_cast<double>(times);
}

void LatencyHistogram::merge(const LatencyHistogram& other) {
    if (other.count_ == 0) return;
    for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
    min_ = count_ == 0 ? other.min_ : std::min(min_, other.min_);
    max_ = std::max(max_, other.max_);
    count_ += other.count_;
    sum_ += other.sum_;
}

void LatencyHistogram::clear() {
    std::fill(counts_.begin(), counts_.end(), 0);
    count_ = min_ = max_ = 0;
    sum_ = 0;
}

nanoseconds LatencyHistogram::min() const noexcept { return as_duration(min_); }
nanoseconds LatencyHistogram::max() const noexcept { return as_duration(max_); }

nanoseconds LatencyHistogram::mean() const noexcept {
    return count_ == 0 ? nanoseconds{0} : nanoseconds{std::llround(sum_ / static_cast<double>(count_))};
}

nanoseconds LatencyHistogram::percentile(double percent) const {
    if (count_ == 0) return nanoseconds{0};
    // Nearest rank. The nudge keeps 99.9 % of 1000 at rank 999 although 99.9 has no exact double.
    const double exact = std::clamp(percent, 0.0, 100.0) / 100 * static_cast<double>(count_);
    const auto rank =
        std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::ceil(exact * (1 - 1e-12))), 1, count_);
    if (rank == count_) return max();
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        seen += counts_[i];
        if (seen < rank) continue;
        const std::uint64_t lowest = lowest_of(i),
                            width = i + 1 < counts_.size() ? lowest_of(i + 1) - lowest : 1;
        return as_duration(std::clamp(lowest + width / 2, min_, max_));
    }
    return max();
}

std::vector<LatencyHistogram::Bucket> LatencyHistogram::filled() const {
    std::vector<Bucket> result;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        if (counts_[i] == 0) continue;
        const std::uint64_t lowest = lowest_of(i);
        const std::uint64_t next = i + 1 < counts_.size() ? lowest_of(i + 1) : std::uint64_t{1} << 63;
        result.push_back({lowest, next - 1, counts_[i]});
    }
    return result;
}

}  // namespace tessera
