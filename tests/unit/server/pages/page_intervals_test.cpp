#include "server/pages/page_intervals.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(PageIntervals, KnowsTheIntervalThatAStepLiesIn) {
    PageIntervals intervals;
    const PageId line{1, 2}, other{1, 3};
    intervals.insert(line, {10, 20});
    intervals.insert(line, {30, never});
    intervals.insert(line, {always, 5});
    EXPECT_EQ(intervals.find(line, 10), (Validity{10, 20}));
    EXPECT_EQ(intervals.find(line, 19), (Validity{10, 20}));
    EXPECT_EQ(intervals.find(line, 20), std::nullopt);
    EXPECT_EQ(intervals.find(line, 9), std::nullopt);
    EXPECT_EQ(intervals.find(line, -1'000'000'000'000'000), (Validity{always, 5}));
    EXPECT_EQ(intervals.find(line, max_step), (Validity{30, never}));
    EXPECT_EQ(intervals.find(other, 12), std::nullopt);
}

TEST(PageIntervals, ForgetsWhatIsNotAskedFor) {
    PageIntervals intervals;
    const PageId asked{1, 1};
    intervals.insert(asked, {0, 10});
    intervals.insert({2, 2}, {0, 10});
    for (std::uint64_t i = 0; i < 200'000; ++i) {
        intervals.insert({3, i}, {0, 10});
        if (i % 1000 == 0) {
            ASSERT_TRUE(intervals.find(asked, 5)) << i;
        }
    }
    EXPECT_FALSE(intervals.find({2, 2}, 5));
}

TEST(PageIntervals, OfOneLineAreBoundedToo) {
    PageIntervals intervals;
    const PageId line{1, 1};
    for (Step step = 0; step < 200'000; ++step) intervals.insert(line, {step, step + 1});
    EXPECT_FALSE(intervals.find(line, 0));
    EXPECT_TRUE(intervals.find(line, 199'999));
}

}  // namespace
}  // namespace tessera
