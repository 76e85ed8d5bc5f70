#include "shared/math/hash.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Hash, IsTheSameOnEveryMachine) {
    // Golden: scenes depend on these bits. They may never change.
    EXPECT_EQ(hash(1, stream("contents"), 2, 3), hash(1, stream("contents"), 2, 3));
    static_assert(mix(1) == 0x5692161d100b05e5u);
    static_assert(stream("a") != stream("a", 1) && stream("a") != stream("b"));
}

TEST(Hash, TellsNeighboursStreamsAndSeedsApart) {
    // Each output bit flips for half of all neighbouring arguments
    std::vector<int> flips(64);
    constexpr int pairs = 20000;
    for (int i = 0; i < pairs; ++i) {
        const std::uint64_t a = hash(5, stream("x"), i - 10000, 7);
        const std::uint64_t b = i % 3 == 0   ? hash(5, stream("x"), i - 9999, 7)
                                : i % 3 == 1 ? hash(5, stream("x"), i - 10000, 8)
                                             : hash(6, stream("x"), i - 10000, 7);
        for (std::size_t bit = 0; bit < 64; ++bit) flips[bit] += (a ^ b) >> bit & 1;
    }
    for (const int count : flips) EXPECT_NEAR(count, pairs / 2, 5 * std::sqrt(pairs) / 2);
}

TEST(Hash, DrawsWithoutBias) {
    // 3·2^30: multiplication alone would make a third of the numbers twice as likely as the others
    constexpr std::uint32_t count = 3u << 30;
    std::vector<int> thirds(3);
    constexpr int draws = 90000;
    for (int i = 0; i < draws; ++i) ++thirds[uniform_below(hash(1, 2, i, 0), count) >> 30];
    for (const int third : thirds) EXPECT_NEAR(third, draws / 3, 5 * std::sqrt(draws * 2.0 / 9));
    EXPECT_EQ(uniform_below(~std::uint64_t{0}, 1), 0u);
}

}  // namespace
}  // namespace tessera
