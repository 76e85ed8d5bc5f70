#include "server/scenes/noise.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Noise, StaysWithinOneAndAveragesToZero) {
    double sum = 0.0, largest = 0.0;
    for (int i = 0; i < 10000; ++i) {
        const double value = noise(0.37 * i - 1000.0, 0.73 * (i % 97), 5);
        sum += value;
        largest = std::max(largest, std::abs(value));
    }
    EXPECT_LT(largest, 1.25);
    EXPECT_GT(largest, 0.6);
    EXPECT_LT(std::abs(sum) / 10000, 0.03);
}

TEST(Noise, IsContinuousAcrossTheLinesOfItsLattice) {
    for (int i = -40; i < 40; ++i)
        EXPECT_NEAR(noise(i - 1e-7, 0.3 * i, 9), noise(i + 1e-7, 0.3 * i, 9), 1e-5) << i;
}

TEST(Noise, RepeatsAfterItsPeriod) {
    for (int i = 0; i < 50; ++i) {
        const double x = 0.31 * i, y = 0.17 * i;
        EXPECT_NEAR(noise(x, y, 3, 8), noise(x + 8.0, y - 16.0, 3, 8), 1e-9);
        EXPECT_NEAR(fractal_noise(x, y, 3, 4, 8), fractal_noise(x + 8.0, y + 8.0, 3, 4, 8), 1e-9);
    }
}

TEST(Noise, FieldsOfDifferentSaltsDiffer) { EXPECT_NE(noise(0.4, 0.6, 1), noise(0.4, 0.6, 2)); }

TEST(Dice, ThrowTheSameAgainFromTheSameKeyAndNeverTheSameNumberTwice) {
    Dice first{7}, second{7};
    std::set<std::uint64_t> seen;
    for (int i = 0; i < 1000; ++i) {
        const std::uint64_t bits = first.bits();
        EXPECT_EQ(bits, second.bits());
        EXPECT_TRUE(seen.insert(bits).second);
    }
}

TEST(Dice, UniformStaysInsideItsIntervalAndFillsIt) {
    Dice dice{11};
    double lowest = 9, highest = -9;
    for (int i = 0; i < 1000; ++i) {
        const double value = dice.uniform(-2.0, 3.0);
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
    }
    EXPECT_GE(lowest, -2.0);
    EXPECT_LT(lowest, -1.9);
    EXPECT_LT(highest, 3.0);
    EXPECT_GT(highest, 2.9);
}

}  // namespace
}  // namespace tessera
