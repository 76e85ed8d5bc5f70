#include "shared/motion/targets.h"

#include <array>

#include <gtest/gtest.h>

namespace tessera {
namespace {

const TimeLine line{std::array<std::uint32_t, 4>{1, 1, 1, 1}};

/// There and back along x, four texels a step.
MovingTarget walker() { return {std::array<MovingTarget::Leg, 2>{{{{0, 0}, 100}, {{400, 0}, 100}}}, 10}; }

TEST(MovingTarget, IsWhereItsStepSays) {
    const MovingTarget target = walker();
    EXPECT_EQ(target.at(10).x, 0);
    EXPECT_EQ(target.at(35).x, 100);
    EXPECT_EQ(target.at(110).x, 400);
    EXPECT_EQ(target.at(160).x, 200);
    EXPECT_EQ(target.at(210).x, 0);
    EXPECT_EQ(target.at(10 - 25).x, 100) << "before its first round";
    EXPECT_EQ(target.at(1'000'000'000'000'010).x, 0) << "10^15 steps are so many whole rounds";
}

TEST(MovingTarget, IsBetweenTexelsExactly) {
    const MovingTarget target{std::array<MovingTarget::Leg, 2>{{{{0, 0}, 3}, {{-10, 1}, 3}}}, 0};
    const auto place = target.at(1);
    EXPECT_EQ(place.parts, 3);
    EXPECT_EQ(place.x * place.parts + place.x_rest, -10);
    EXPECT_EQ(place.y * place.parts + place.y_rest, 1);
}

TEST(TargetDistance, OpensAndClosesAsATargetPasses) {
    const std::array targets{walker()};
    const TargetDistance distance{line, 0, 80, targets};
    // At x = 200, y = 0: the target is 200 away at step 10; it is there at 60
    EXPECT_EQ(distance.frame_at({200, 0}, 10), 0);
    EXPECT_EQ(distance.frame_at({200, 0}, 60), 3);
    std::int32_t last = 0;
    for (Step step = 10; step <= 60; ++step) {
        const std::int32_t frame = distance.frame_at({200, 0}, step);
        EXPECT_GE(frame, last);
        EXPECT_LE(frame, last + 1);
        last = frame;
    }
    // 60 away, where the second quarter begins, at x = 140: step 45
    const auto answer = distance.shown_at({200, 0}, 20);
    EXPECT_EQ(answer.validity.until, 45);
    EXPECT_EQ(answer.validity.from, -25 + 1) << "since it left, the round before: at −25 it was 60 away";
}

TEST(TargetDistance, OutOfReachIsStatic) {
    const std::array targets{walker()};
    const TargetDistance distance{line, 0, 80, targets};
    EXPECT_TRUE(distance.shown_at({200, 1000}, 20).validity.is_static());
    EXPECT_TRUE(
        distance.shown_at({std::int64_t{1} << 40, -(std::int64_t{1} << 40)}, 20).validity.is_static());
}

}  // namespace
}  // namespace tessera
