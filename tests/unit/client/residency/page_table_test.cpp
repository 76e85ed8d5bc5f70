#include "client/residency/page_table.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(PageTable, ShowsTheFinestResidentAncestorOfAMissingPage) {
    PageTable table{Extent{20}, 32};
    table.show({3, 0, 0}, {.slot = 7});
    table.show({1, 2, 1}, {.slot = 9});
    EXPECT_EQ(table.shown_for({0, 4, 3})->slot, 9);
    EXPECT_EQ(table.shown_for({0, 0, 0})->slot, 7);
    EXPECT_FALSE(table.shown_for({0, 8, 0}));
    table.hide({1, 2, 1});
    EXPECT_EQ(table.shown_for({0, 4, 3})->slot, 7);
    EXPECT_EQ(table.shown_for({0, 4, 3})->level, 3);
}

TEST(PageTable, RewritesOnlyTheLevelsThatAMoveReaches) {
    PageTable table{Extent{20}, 32};
    table.move_to(1 << 20, 1 << 20);
    table.take_changed_levels();
    table.move_to((1 << 20) + 255, 1 << 20);
    EXPECT_TRUE(table.take_changed_levels().empty());
    table.move_to((1 << 20) + 256, 1 << 20);
    EXPECT_EQ(table.take_changed_levels(), std::vector<std::uint8_t>{0});
}

}  // namespace
}  // namespace tessera
