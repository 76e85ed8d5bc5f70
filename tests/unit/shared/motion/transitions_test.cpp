#include "shared/motion/transitions.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace tessera {
namespace {

const TimeLine line{std::array<std::uint32_t, 4>{1, 1, 1, 1}};

std::vector<std::int32_t> shown(const Cycle& from, const Cycle& to, Step at, Step until) {
    std::vector<std::int32_t> frames;
    for (Step step = 0; step < until; ++step) frames.push_back(frame_at(line, from, to, at, step));
    return frames;
}

TEST(Transition, LetsTheOldRunEndAndGoesOnWithANewThatRests) {
    // Old: 1 2 3 from step 3 on. Changed at 4; at 6, where it ends, the new cycle rests until 9
    EXPECT_EQ(shown({.phase = 0, .rest = 2}, {.phase = 0, .rest = 8}, 4, 14),
              (std::vector<std::int32_t>{0, 0, 0, 1, 2, 3, 0, 0, 0, 1, 2, 3, 0, 0}));
}

TEST(Transition, ShowsRestWhereTheNewRunHasBegun) {
    // The old run ends at 6, where the new one is at 2: nothing until that is over, at 8
    EXPECT_EQ(shown({.phase = 0, .rest = 2}, {.phase = 0, .rest = 0}, 4, 14),
              (std::vector<std::int32_t>{0, 0, 0, 1, 2, 3, 0, 0, 0, 1, 2, 3, 0, 1}));
}

TEST(Transition, OfACellAtRestDoesNotJumpFromItsLastFrame) {
    // The old run ends at 5. Changed at 6, at rest; the new cycle shows frame 1 at 6, and rests at 5.
    const Cycle from{.phase = 0, .rest = 2}, to{.phase = 2, .rest = 0};
    ASSERT_EQ(frame_at(line, from, to, 6, 5), 3);
    ASSERT_EQ(position_at(line, to, 6), 0);
    ASSERT_EQ(position_at(line, {.phase = 3, .rest = 0}, 6), 1);
    EXPECT_EQ(frame_at(line, from, {.phase = 3, .rest = 0}, 6, 6), 0) << "the paper goes on with frame 1";
    EXPECT_EQ(frame_at(line, from, {.phase = 3, .rest = 0}, 6, 7), 0) << "its run has begun without it";
}

TEST(ChangeTimes, LetChangesWaitUntilItIsSafe) {
    ChangeTimes times{line};
    EXPECT_EQ(steps_between_changes(line), 6);
    EXPECT_EQ(times.add(100).step, 100);
    EXPECT_EQ(times.effect_of(103).step, 106);
    const auto first = times.add(103);
    EXPECT_EQ(first.step, 106);
    EXPECT_FALSE(first.replaces);
    const auto second = times.add(105);
    EXPECT_EQ(second.step, 106);
    EXPECT_TRUE(second.replaces) << "a slider builds no queue";
    EXPECT_EQ(times.steps().size(), 2u);
    EXPECT_EQ(times.add(500).step, 500);
    EXPECT_EQ(times.steps().size(), 3u);
}

TEST(ChangeTimes, TakesAnotherAtTheVeryStepOfAChange) {
    ChangeTimes times{line};
    times.add(10);
    EXPECT_TRUE(times.add(10).replaces);
    EXPECT_EQ(times.steps().size(), 1u);
}

TEST(Transitions, AreValidAcrossChangesThatDoNotShow) {
    // For ever at rest, through two changes
    const std::array<Cycle, 3> cycles{{{0, endless_rest}, {5, endless_rest}, {0, endless_rest}}};
    const std::array<Step, 2> changes{100, 200};
    EXPECT_TRUE(shown_at(line, cycles, changes, 150).validity.is_static());

    // At rest until a second change lets it run: the last change of a frame was never
    const std::array<Cycle, 3> wakes{{{0, endless_rest}, {5, endless_rest}, {0, 0}}};
    const Shown shown = shown_at(line, wakes, changes, 50);
    EXPECT_EQ(shown.validity, (Validity{always, 201}));
    EXPECT_EQ(frame_at(line, wakes, changes, 201), 1);
}

}  // namespace
}  // namespace tessera
