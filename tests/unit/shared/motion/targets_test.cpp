#include "shared/motion/targets.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "shared/math/hash.h"

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

/// A target that waits, walks aslant and comes back; and one that stands.
std::vector<MovingTarget> some_targets() {
    const std::array<MovingTarget::Leg, 4> legs{
        {{{0, 0}, 60}, {{0, 0}, 90}, {{700, 310}, 70}, {{-200, 500}, 80}}};
    const std::array<MovingTarget::Leg, 1> stands{{{{400, 400}, 1}}};
    return {{legs, 5}, {stands, 0}};
}

TEST(TargetDistance, AlongARowIsWhatEachPlaceShows) {
    const TimeLine frames{std::array<std::uint32_t, 5>{3, 1, 2, 1, 4}};
    const auto targets = some_targets();
    const TargetDistance law{frames, 30, 260, targets};
    std::vector<std::int32_t> shown(40);
    int seen = 0;
    for (Step step = -400; step < 400; step += 7)
        for (std::int64_t y = -300; y < 800; y += 137) {
            const MotionRow row{{-350, y}, 32, 40};
            Validity along, each;
            law.shown_along(row, step, shown.data(), &along);
            for (std::int32_t i = 0; i < row.count; ++i) {
                const auto one = law.shown_at({row.first.x + i * row.spacing, y}, step);
                ASSERT_EQ(shown[static_cast<std::size_t>(i)], one.frame) << step << ", " << y << ", " << i;
                each.meet(one.validity);
                seen += one.frame;
            }
            ASSERT_EQ(along, each) << step << ", " << y;
        }
    EXPECT_GT(seen, 1000);
}

TEST(TargetDistance, KnowsHowLongALatticeRests) {
    const TimeLine frames{std::array<std::uint32_t, 3>{1, 2, 4}};
    const auto targets = some_targets();
    const TargetDistance law{frames, 10, 90, targets};
    std::vector<std::int32_t> shown(12);
    int rests = 0, ends = 0;
    for (Step step = -320; step < 640; step += 3)
        for (std::int64_t y = -200; y < 900; y += 173)
            for (std::int64_t x = -300; x < 900; x += 211) {
                const MotionLattice places{{x, y}, 16, 12, 5};
                Validity all;
                bool first = true;
                for (std::int64_t row = 0; row < places.rows; ++row) {
                    law.shown_along({{x, y + row * 16}, 16, 12}, step, shown.data(), &all);
                    first &= std::all_of(shown.begin(), shown.end(), [](std::int32_t f) { return f == 0; });
                }
                const auto rest = law.rest_of(places, step);
                if (!rest) continue;
                ASSERT_TRUE(first) << step;
                ASSERT_EQ(*rest, all) << step << " at " << x << ", " << y;
                ++rests;
                ends += !rest->is_static();
            }
    EXPECT_GT(rests, 5000);
    EXPECT_GT(ends, 500);
}

TEST(TargetDistance, KnowsHowLongALatticeStaysAsItIs) {
    const TimeLine frames{std::array<std::uint32_t, 5>{3, 1, 2, 1, 4}};
    std::vector<MovingTarget> targets = some_targets();
    // One more that goes over the same places, so that rings hide each other; and a fast one
    targets.emplace_back(
        std::array<MovingTarget::Leg, 3>{{{{-100, 350}, 120}, {{650, 300}, 1}, {{-500, -200}, 179}}}, 40);
    const std::array<MotionLattice, 7> lattices{{{{-310, -300}, 32, 33, 29},
                                                 {{160, 93}, 16, 4, 5},
                                                 {{200, 130}, 8, 24, 1},
                                                 {{600, 210}, 40, 1, 9},
                                                 {{-170, 480}, 300, 3, 3},
                                                 {{380, 390}, 1, 9, 9},
                                                 {{-2000, 0}, 64, 40, 12}}};
    int ends = 0, long_ones = 0;
    for (const std::size_t count : {targets.size(), std::size_t{1}, std::size_t{2}})
        for (const std::int64_t near : {3, 30, 240}) {
            const TargetDistance law{frames, near, 260, std::span{targets}.first(count)};
            for (const MotionLattice& places : lattices)
                for (Step step = -330; step < 400; step += 23) {
                    Validity narrowed, each;
                    law.narrow(places, step, narrowed);
                    for (std::int64_t row = 0; row < places.rows; ++row)
                        for (std::int64_t column = 0; column < places.columns; ++column)
                            each.meet(law.shown_at({places.first.x + column * places.spacing,
                                                    places.first.y + row * places.spacing},
                                                   step)
                                          .validity);
                    ASSERT_EQ(narrowed, each) << step << " at " << places.first.x << ", near " << near;
                    Validity within{step - 4, step + 3};
                    law.narrow(places, step, within);
                    each.meet({step - 4, step + 3});
                    ASSERT_EQ(within, each) << step << " at " << places.first.x;
                    ends += !narrowed.is_static();
                    long_ones += !narrowed.is_static() && narrowed.until - narrowed.from > 3;
                }
        }
    EXPECT_GT(ends, 1000);
    EXPECT_GT(long_ones, 300);
}

/// Doubles pick which places are asked, and far off they are coarse: a target that only grazes a ring on its
/// way past must not be missed.
TEST(TargetDistance, KnowsHowLongALatticeStaysAsItIsWhereATargetComesFromFarAway) {
    const TimeLine two{std::array<std::uint32_t, 2>{1, 1}};
    const MotionLattice places{{8, 8}, 16, 3, 3};
    int ends = 0;
    for (std::int64_t i = 0; i < 4000; ++i) {
        const auto dice = [&](std::int64_t which, std::int64_t count) {
            return static_cast<std::int64_t>(hash(5, stream("far"), i, which) %
                                             static_cast<std::uint64_t>(count));
        };
        const std::int64_t far = 1 + dice(0, 60),
                           away = (std::int64_t{1} << (14 + dice(1, 24))) + dice(2, 9999);
        // Past one of the places, about as far from it as the ring reaches
        const std::int64_t x = 8 + 16 * dice(3, 3) + (far + dice(4, 3) - 1) * (2 * dice(5, 2) - 1);
        const std::int64_t slant = dice(6, 5) - 2, y = 24;
        const auto steps = static_cast<std::uint32_t>(1 + dice(7, std::int64_t{1} << 20));
        const std::array<MovingTarget::Leg, 2> legs{
            {{{x + slant, y - away}, steps}, {{x - slant, y + away}, steps}}};
        const std::array targets{MovingTarget{legs, 0}};
        const TargetDistance law{two, 0, far, targets};
        const Step step = dice(8, 2 * std::int64_t{steps});
        Validity narrowed, each;
        law.narrow(places, step, narrowed);
        for (std::int64_t row = 0; row < places.rows; ++row)
            for (std::int64_t column = 0; column < places.columns; ++column)
                each.meet(law.shown_at({places.first.x + column * places.spacing,
                                        places.first.y + row * places.spacing},
                                       step)
                              .validity);
        ASSERT_EQ(narrowed, each) << i;
        ends += !each.is_static();
    }
    EXPECT_GT(ends, 500);
}

TEST(TargetDistance, LooksNoFurtherThanItIsAsked) {
    const auto targets = some_targets();
    const TargetDistance law{line, 0, 200, targets};
    for (Step step = 0; step < 300; ++step)
        for (const Step reach : {1, 5, 60}) {
            const Validity within{step - reach, step + reach};
            const MotionPoint cell{300, 200};
            Validity whole = law.shown_at(cell, step).validity,
                     part = law.shown_at(cell, step, within).validity;
            whole.meet(within);
            part.meet(within);
            ASSERT_EQ(whole, part) << step << ", " << reach;
        }
}

TEST(MovingTarget, StaysInTheBoxOfItsSteps) {
    for (const MovingTarget& target : some_targets())
        for (Step from = -100; from < 500; from += 13)
            for (const Step steps : {1, 2, 40, 150, 1000}) {
                const auto box = target.box(from, from + steps);
                bool left = false, right = false;
                for (Step step = from; step < from + steps; ++step) {
                    const auto place = target.at(step);
                    ASSERT_LE(box.least.x, place.x);
                    ASSERT_GE(box.most.x, place.x + (place.x_rest > 0));
                    ASSERT_LE(box.least.y, place.y);
                    ASSERT_GE(box.most.y, place.y + (place.y_rest > 0));
                    left |= box.least.x == place.x;
                    right |= box.most.x == place.x + (place.x_rest > 0);
                }
                ASSERT_TRUE(left && right) << "no larger than need be";
            }
}

}  // namespace
}  // namespace tessera
