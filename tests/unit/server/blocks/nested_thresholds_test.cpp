#include "server/blocks/nested_thresholds.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(NestedThresholds, EveryAlignedBlockHasOneInEachStratum) {
    std::mt19937_64 random{3};
    for (int j = 1; j <= 6; ++j) {
        const int side = 1 << j;
        for (int block = 0; block < 60; ++block) {
            const NestedThresholds thresholds{random(), static_cast<std::int64_t>(random() % 5)};
            const std::int64_t x =
                (static_cast<std::int64_t>(random() >> 24) - (std::int64_t{1} << 39)) / side * side;
            const std::int64_t y =
                (static_cast<std::int64_t>(random() >> 24) - (std::int64_t{1} << 39)) / side * side;
            std::vector<int> seen(static_cast<std::size_t>(side * side), 0);
            std::vector<std::uint32_t> row(static_cast<std::size_t>(side));
            for (int dy = 0; dy < side; ++dy) {
                thresholds.row(x, y + dy, side, row.data());
                for (const std::uint32_t threshold : row) ++seen[threshold >> (32 - 2 * j)];
            }
            ASSERT_EQ(std::count(seen.begin(), seen.end(), 1), side * side) << j;
        }
    }
}

TEST(NestedThresholds, NeighboursAvoidEachOther) {
    // DESIGN section 2: a correlation of −0.16
    const NestedThresholds thresholds{5, 0};
    double product = 0, square = 0;
    std::vector<std::uint32_t> row(1024);
    for (int y = 0; y < 400; ++y) {
        thresholds.row(0, y, 1024, row.data());
        for (std::size_t i = 0; i + 1 < row.size(); ++i) {
            const double a = row[i] / 4294967296.0 - 0.5, b = row[i + 1] / 4294967296.0 - 0.5;
            product += a * b;
            square += a * a;
        }
    }
    EXPECT_NEAR(product / square, -0.16, 0.02);
}

}  // namespace
}  // namespace tessera
