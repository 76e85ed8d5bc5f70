#include "shared/page/page_key.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(Extent, HoldsOnePageOnItsCoarsestLevel) {
    const Extent extent{.n = 30};
    EXPECT_EQ(extent.side_texels(), std::int64_t{1} << 38);
    EXPECT_EQ(extent.side_pages(30), 1u);
    EXPECT_EQ(extent.side_pages(0), 1u << 30);
    EXPECT_TRUE(extent.contains({.level = 30, .x = 0, .y = 0}));
    EXPECT_FALSE(extent.contains({.level = 30, .x = 1, .y = 0}));
    EXPECT_FALSE(extent.contains({.level = 31, .x = 0, .y = 0}));
    EXPECT_EQ(extent.zoom(30), 0);
}

TEST(PageKey, AParentCoversItsFourChildren) {
    for (const std::uint32_t x : {6u, 7u})
        for (const std::uint32_t y : {10u, 11u}) {
            const PageKey expected{.level = 4, .x = 3, .y = 5};
            EXPECT_EQ(parent({.level = 3, .x = x, .y = y}), expected);
        }
}

TEST(RegionOf, GrowsByTheGutterOnEverySide) {
    EXPECT_EQ(region_of({.level = 2, .x = 0, .y = 3}, 4), (TexelRegion{2, -4, 764, 264, 264}));
}

}  // namespace
}  // namespace tessera
