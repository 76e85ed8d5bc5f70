#include "client/load/histogram.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "shared/math/hash.h"

namespace tessera {
namespace {

using std::chrono::nanoseconds;

/// Durations spread over many orders of magnitude, as latencies are.
std::vector<std::int64_t> spread_values(std::uint64_t seed, std::size_t count) {
    std::vector<std::int64_t> values;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t bits = hash(seed, stream("durations"), static_cast<std::int64_t>(i), 0);
        values.push_back(static_cast<std::int64_t>(bits >> (2 + bits % 61)));
    }
    return values;
}

LatencyHistogram histogram_of(const std::vector<std::int64_t>& values) {
    LatencyHistogram histogram;
    for (const std::int64_t value : values) histogram.record(nanoseconds{value});
    return histogram;
}

TEST(LatencyHistogram, GivesEveryPercentileOfASortedVectorWithinItsError) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        SCOPED_TRACE(seed);
        std::vector<std::int64_t> values = spread_values(seed, 10'000);
        const LatencyHistogram histogram = histogram_of(values);
        std::sort(values.begin(), values.end());
        for (double percent = 0; percent <= 100; percent += 0.5) {
            const auto rank = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(percent * 100)));
            const auto expected = static_cast<double>(values[rank - 1]);
            const auto actual = static_cast<double>(histogram.percentile(percent).count());
            EXPECT_NEAR(actual, expected, expected * LatencyHistogram::relative_error) << percent;
        }
    }
}

TEST(LatencyHistogram, IsExactBelow256NanosecondsAndAtItsEnds) {
    for (std::int64_t value = 0; value < 256; ++value) {
        LatencyHistogram histogram = histogram_of({value, 1'000'000'007, 1'000'000'007});
        EXPECT_EQ(histogram.percentile(10).count(), value);
        EXPECT_EQ(histogram.min().count(), value);
        EXPECT_EQ(histogram.max().count(), 1'000'000'007);
        EXPECT_EQ(histogram.percentile(100).count(), 1'000'000'007);
    }
}

TEST(LatencyHistogram, TakesEveryDurationThereIs) {
    const LatencyHistogram histogram = histogram_of({nanoseconds::max().count(), -5, 0});
    EXPECT_EQ(histogram.max(), nanoseconds::max());
    EXPECT_EQ(histogram.min().count(), 0);
    EXPECT_EQ(histogram.count(), 3u);
}

TEST(LatencyHistogram, MergesAsIfAllHadBeenRecordedInOne) {
    const std::vector<std::int64_t> left = spread_values(4, 3000), right = spread_values(5, 500);
    std::vector<std::int64_t> both = left;
    both.insert(both.end(), right.begin(), right.end());
    LatencyHistogram merged = histogram_of(left);
    merged.merge(histogram_of(right));
    merged.merge(LatencyHistogram{});
    const LatencyHistogram expected = histogram_of(both);
    EXPECT_EQ(merged.count(), expected.count());
    EXPECT_EQ(merged.min(), expected.min());
    EXPECT_EQ(merged.max(), expected.max());
    EXPECT_NEAR(static_cast<double>(merged.mean().count()), static_cast<double>(expected.mean().count()),
                1e3);
    for (const double percent : {1.0, 50.0, 99.0, 99.9})
        EXPECT_EQ(merged.percentile(percent), expected.percentile(percent));
}

TEST(LatencyHistogram, ListsBucketsThatMeetWithoutGapsAndHoldTheirValues) {
    const std::vector<std::int64_t> values = spread_values(6, 2000);
    const auto buckets = histogram_of(values).filled();
    std::uint64_t total = 0, below = 0;
    for (const auto& bucket : buckets) {
        EXPECT_GE(bucket.lowest, below);
        EXPECT_GE(bucket.highest, bucket.lowest);
        below = bucket.highest + 1;
        const auto inside = std::count_if(values.begin(), values.end(), [&](std::int64_t value) {
            return static_cast<std::uint64_t>(value) >= bucket.lowest &&
                   static_cast<std::uint64_t>(value) <= bucket.highest;
        });
        EXPECT_EQ(static_cast<std::uint64_t>(inside), bucket.count);
        total += bucket.count;
    }
    EXPECT_EQ(total, 2000u);
}

TEST(LatencyHistogram, CountsRepeatsAndForgetsWhenCleared) {
    LatencyHistogram histogram;
    histogram.record(nanoseconds{10}, 99);
    histogram.record(nanoseconds{200}, 1);
    EXPECT_EQ(histogram.percentile(99).count(), 10);
    EXPECT_EQ(histogram.percentile(99.5).count(), 200);
    EXPECT_EQ(histogram.mean().count(), 12);
    histogram.clear();
    EXPECT_EQ(histogram.count(), 0u);
    EXPECT_EQ(histogram.percentile(50).count(), 0);
    EXPECT_EQ(histogram.max().count(), 0);
}

}  // namespace
}  // namespace tessera
