#include "shared/motion/cycle.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>

namespace tessera {
namespace {

constexpr std::array<std::uint32_t, 4> ones{1, 1, 1, 1};

TEST(Cycle, RestsThenRunsAsInFigure12) {
    // φ = 3 and Z = 2 of four frames: a cycle of six, three steps ahead
    const TimeLine line{ones};
    const std::array<std::int64_t, 12> expected{1, 2, 3, 0, 0, 0, 1, 2, 3, 0, 0, 0};
    for (Step step = 0; step < 12; ++step)
        EXPECT_EQ(position_at(line, {.phase = 3, .rest = 2}, step), expected[static_cast<std::size_t>(step)])
            << step;
}

TEST(Cycle, StaysExactWhereSumsWouldOverflow) {
    const TimeLine line{ones};
    constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
    // 2·(2^63 − 1) is 4 modulo the cycle's 5 steps, of which the first rests
    EXPECT_EQ(position_at(line, {.phase = most, .rest = 1}, most), 3);
    // −2^63 + 2^63 − 2
    EXPECT_EQ(position_at(line, {.phase = std::numeric_limits<std::int64_t>::min(), .rest = 1}, most - 1),
              position_at(line, {.phase = -2, .rest = 1}, 0));
    // 10^15 + 10^9 is 996000000 modulo 10^9 + 4
    const Cycle slow{.phase = 1'000'000'000, .rest = 1'000'000'000};
    EXPECT_EQ(
        shown_at(line, slow, 1'000'000'000'000'000).validity,
        (Validity{1'000'000'000'000'000 - 996000000, 1'000'000'000'000'000 + 1'000'000'001 - 996000000}));
}

TEST(Cycle, ThatNeverRunsIsStatic) {
    const TimeLine line{ones};
    const Shown shown = shown_at(line, {.phase = 17, .rest = endless_rest}, 1'000'000'000'000'000);
    EXPECT_EQ(shown.frame, 0);
    EXPECT_TRUE(shown.validity.is_static());
}

TEST(Cycle, OfOneFrameIsStatic) {
    const TimeLine line{std::array<std::uint32_t, 1>{7}};
    EXPECT_TRUE(shown_at(line, {.phase = 3, .rest = 5}, 100).validity.is_static());
    EXPECT_EQ(position_at(line, {.phase = 3, .rest = 5}, 100), 0);
}

TEST(Cycle, TellsWhenItsFrameChanges) {
    const TimeLine line{std::array<std::uint32_t, 3>{2, 3, 1}};
    const Cycle cycle{.phase = 0, .rest = 4};  // 0 for 6 steps, 1 for 3, 2 for 1
    EXPECT_EQ(shown_at(line, cycle, 2).validity, (Validity{0, 6}));
    EXPECT_EQ(shown_at(line, cycle, 7).validity, (Validity{6, 9}));
    EXPECT_EQ(shown_at(line, cycle, 9).validity, (Validity{9, 10}));
    EXPECT_EQ(shown_at(line, cycle, -1).validity, (Validity{-1, 0}));
}

TEST(Cycle, WhoseFrameOutlastsTheClockIsValidForEver) {
    const TimeLine line{ones};
    const Shown shown = shown_at(line, {.phase = 0, .rest = endless_rest - 1}, never - 5);
    EXPECT_EQ(shown.validity.until, never);
}

TEST(Rest, IsRoundedDownAndEndless) {
    EXPECT_EQ(rest_of(7, 65536), 7);
    EXPECT_EQ(rest_of(7, 32768), 3);
    EXPECT_EQ(rest_of(7, 0), 0);
    EXPECT_EQ(rest_of(1'000'000'000, 65536 * 3 / 2), 1'500'000'000);
    EXPECT_EQ(rest_of(1, endless_density), endless_rest);
    EXPECT_EQ(rest_of(0, endless_density), 0);
    EXPECT_EQ(rest_of(std::numeric_limits<std::int64_t>::max(), endless_density - 1), endless_rest);
}

TEST(Parameter, WalksTheFramesInOrder) {
    const TimeLine line{std::array<std::uint32_t, 3>{5, 2, 1}};  // Positions: 0, then two of 1, then one of 2
    EXPECT_EQ(frame_of_parameter(line, -5), 0);
    EXPECT_EQ(frame_of_parameter(line, 0), 0);
    EXPECT_EQ(frame_of_parameter(line, 16384), 1);
    EXPECT_EQ(frame_of_parameter(line, 49151), 1);
    EXPECT_EQ(frame_of_parameter(line, 49152), 2);
    EXPECT_EQ(frame_of_parameter(line, 1'000'000), 2);
}

}  // namespace
}  // namespace tessera
