#include "server/texture/typed_quadtree.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(TypedQuadtree, ANodeHasOneTypeWhateverRectangleAsksForIt) {
    const TypedQuadtree tree{7, 256};
    for (const std::int64_t origin : {std::int64_t{0}, std::int64_t{-1000}, std::int64_t{1} << 34})
        for (const int height : {0, 1, 5, 20}) {
            const TypeGrid whole = tree.types_of(height, origin - 20, origin + 3, 60, 50);
            const TypeGrid part = tree.types_of(height, origin + 1, origin + 10, 7, 9);
            for (std::int64_t y = origin + 10; y < origin + 19; ++y)
                for (std::int64_t x = origin + 1; x < origin + 8; ++x)
                    ASSERT_EQ(whole.at(x, y), part.at(x, y));
        }
}

TEST(TypedQuadtree, FourLeavesAloneAreThoseOfTheirRectangle) {
    const TypedQuadtree tree{11, 128};
    for (const std::int64_t at :
         {std::int64_t{-1}, std::int64_t{0}, std::int64_t{7}, (std::int64_t{1} << 36) - 1})
        for (const int across : {0, 1})
            for (const int down : {0, 1}) {
                const TypeGrid grid = tree.types_of(0, at, -at, 2, 2);
                const TypedQuadtree::Square square = tree.square_at(at, -at, across, down);
                for (std::int64_t y = 0; y <= down; ++y)
                    for (std::int64_t x = 0; x <= across; ++x)
                        ASSERT_EQ(square.at[std::size_t(y)][std::size_t(x)], grid.at(at + x, -at + y));
            }
}

TEST(TypedQuadtree, OneLeafIsTheSameInEveryQuadrantWhetherNearTheOriginOrBeyondTheRoots) {
    const TypedQuadtree tree{11, 128};
    const std::int64_t far = std::int64_t{1} << TypedQuadtree::root_height;
    for (const std::int64_t x : {-far - 5, -far, std::int64_t{-70000}, std::int64_t{-2}, std::int64_t{-1},
                                 std::int64_t{0}, std::int64_t{1}, std::int64_t{1234567}, far - 1, far})
        for (const std::int64_t y :
             {-far - 1, std::int64_t{-4}, std::int64_t{-1}, std::int64_t{0}, std::int64_t{99}, far + 7})
            ASSERT_EQ(tree.square_at(x, y, 0, 0).at[0][0], tree.types_of(0, x, y, 1, 1).at(x, y))
                << x << ", " << y;
}

TEST(TypedQuadtree, AParentDecidesItsChildren) {
    const TypedQuadtree tree{7, 1024};
    for (const int height : {1, 4, 30}) {
        const TypeGrid parents = tree.types_of(height, -9, -9, 18, 18);
        const TypeGrid children = tree.types_of(height - 1, -18, -18, 36, 36);
        for (std::int64_t y = -9; y < 9; ++y)
            for (std::int64_t x = -9; x < 9; ++x)
                for (std::size_t c = 0; c < 4; ++c)
                    ASSERT_EQ(children.at(2 * x + std::int64_t(c % 2), 2 * y + std::int64_t(c / 2)),
                              tree.children(height, parents.at(x, y))[c]);
    }
}

TEST(TypedQuadtree, EveryTypeIsAChildEquallyOftenAtEveryHeight) {
    const TypedQuadtree tree{3, 128};
    for (int height = 1; height <= TypedQuadtree::root_height; ++height) {
        std::vector<int> counts(128);
        for (std::uint16_t type = 0; type < 128; ++type)
            for (const std::uint16_t child : tree.children(height, type)) ++counts[child];
        for (const int count : counts) ASSERT_EQ(count, 4);
    }
}

TEST(TypedQuadtree, ALiftedTreeIsTheSameSeenFromLargerOrSmallerUnits) {
    const TypedQuadtree tree{5, 256};
    for (const int heights : {1, 4, 12, -1, -5, -12}) {
        const TypedQuadtree lifted = tree.lifted(heights);
        EXPECT_TRUE(tree.is_lifted(lifted, heights));
        EXPECT_FALSE(tree.is_lifted(lifted, heights + 1));
        for (const std::int64_t at : {std::int64_t{-300}, std::int64_t{1} << 23}) {
            const int height = std::max(heights, 0);
            const TypeGrid here = tree.types_of(height, at, -at, 20, 9, 3),
                           there = lifted.types_of(height - heights, at, -at, 20, 9, 3);
            for (std::int64_t y = -at; y < -at + 9; ++y)
                for (std::int64_t x = at; x < at + 20; ++x)
                    ASSERT_EQ(here.at(x, y), there.at(x, y)) << heights;
        }
    }
}

TEST(TypedQuadtree, AnotherSeedIsAnotherTree) {
    const TypeGrid a = TypedQuadtree{1, 4096}.types_of(0, 0, 0, 64, 64),
                   b = TypedQuadtree{2, 4096}.types_of(0, 0, 0, 64, 64);
    int equal = 0;
    for (std::int64_t y = 0; y < 64; ++y)
        for (std::int64_t x = 0; x < 64; ++x) equal += a.at(x, y) == b.at(x, y);
    EXPECT_LT(equal, 64);
}

}  // namespace
}  // namespace tessera
