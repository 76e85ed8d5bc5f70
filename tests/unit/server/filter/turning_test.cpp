#include "server/filter/turning.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Turning, IsExactAtQuarterTurns) {
    const Turning none = turning(0), quarter = turning(0.25), half = turning(0.5), three = turning(0.75);
    EXPECT_EQ(none.cosine, 1.0);
    EXPECT_EQ(none.sine, 0.0);
    EXPECT_EQ(quarter.cosine, 0.0);
    EXPECT_EQ(quarter.sine, 1.0);
    EXPECT_EQ(half.cosine, -1.0);
    EXPECT_EQ(half.sine, 0.0);
    EXPECT_EQ(three.cosine, 0.0);
    EXPECT_EQ(three.sine, -1.0);
}

TEST(Turning, AgreesWithTheLibraryAllAround) {
    for (int k = -1000; k <= 3000; ++k) {
        const double turns = k / 1000.0;
        const Turning t = turning(turns);
        EXPECT_NEAR(t.cosine, std::cos(2 * std::numbers::pi * turns), 4e-15) << turns;
        EXPECT_NEAR(t.sine, std::sin(2 * std::numbers::pi * turns), 4e-15) << turns;
        EXPECT_NEAR(t.cosine * t.cosine + t.sine * t.sine, 1.0, 1e-15);
    }
}

TEST(BoundingSide, HoldsTheTurnedSquareAndNoTexelMore) {
    EXPECT_EQ(bounding_side(64, 1, 0), 64);
    EXPECT_EQ(bounding_side(64, 1, 0.25), 64);
    EXPECT_EQ(bounding_side(64, 1, 0.125), 91);  // 64·√2 = 90.51
    EXPECT_EQ(bounding_side(64, 0.7, 0), 45);
    EXPECT_EQ(bounding_side(64, 0.75, 0.5), 48);
    EXPECT_EQ(bounding_side(1, 1.0 / 64, 0), 1);
    static_assert(bounding_side(1024, 4, 0.125) == 5793);
}

}  // namespace
}  // namespace tessera
