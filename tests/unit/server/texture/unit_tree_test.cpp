#include "server/texture/unit_tree.h"

#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace tessera {
namespace {

constexpr std::int64_t far_off = (std::int64_t{1} << 34) - 9;

TEST(UnitTree, keeps_the_units_under_one_node_in_classes_of_their_own_and_tells_them_by_its_class) {
    for (const int apart : {1, 2}) {
        const UnitTree tree{5, 512, apart};
        const std::int64_t side = std::int64_t{1} << apart;
        // What a node's class says, wherever it is
        std::vector<std::set<std::uint32_t>> classes_of(UnitTree::classes >> (2 * apart));
        for (const std::int64_t origin : {std::int64_t{0}, far_off & -side, -far_off & -side})
            for (std::int64_t by = 0; by < 16; ++by)
                for (std::int64_t bx = 0; bx < 16; ++bx) {
                    const std::int64_t x = origin + bx * side, y = by * side - origin;
                    const TypeGrid units = tree.types_of(0, x, y, static_cast<std::int32_t>(side),
                                                         static_cast<std::int32_t>(side));
                    std::set<std::uint32_t> classes;
                    for (std::int64_t v = 0; v < side; ++v)
                        for (std::int64_t u = 0; u < side; ++u)
                            classes.insert(units.at(x + u, y + v) % UnitTree::classes);
                    ASSERT_EQ(classes.size(), std::size_t(side * side)) << x << ", " << y;
                    const std::uint16_t node =
                        tree.types_of(apart, x >> apart, y >> apart, 1, 1).at(x >> apart, y >> apart);
                    auto& known = classes_of[node % classes_of.size()];
                    if (known.empty()) known = classes;
                    ASSERT_EQ(known, classes);
                }
    }
}

TEST(UnitTree, has_every_type_equally_often_at_every_height) {
    for (const int apart : {0, 1, 2}) {
        const UnitTree tree{7, 128, apart};
        for (int height = 1; height <= 4; ++height) {
            std::vector<int> times(128);
            for (std::uint16_t type = 0; type < 128; ++type)
                for (const std::uint16_t child : tree.children(height, type)) ++times[child];
            EXPECT_EQ(times, std::vector<int>(128, 4)) << height;
        }
    }
}

TEST(UnitTree, gives_rectangles_and_squares_the_types_that_nodes_decide) {
    for (const int apart : {0, 1, 2}) {
        const UnitTree tree{9, 256, apart};
        for (const std::int64_t at : {std::int64_t{-6}, far_off}) {
            for (int height = 0; height < 4; ++height) {
                const TypeGrid below = tree.types_of(height, at, at + 3, 11, 7);
                for (std::int64_t y = at + 3; y < at + 10; ++y)
                    for (std::int64_t x = at; x < at + 11; ++x) {
                        const TypeGrid above = tree.types_of(height + 1, x >> 1, y >> 1, 1, 1);
                        const auto quadrant = static_cast<std::size_t>((x & 1) | (y & 1) << 1);
                        ASSERT_EQ(below.at(x, y),
                                  tree.children(height + 1, above.at(x >> 1, y >> 1))[quadrant]);
                    }
            }
            for (std::int64_t y = at; y < at + 9; ++y)
                for (std::int64_t x = at; x < at + 9; ++x) {
                    const auto square = tree.square_at(x, y, 1, 1);
                    const TypeGrid grid = tree.types_of(0, x, y, 2, 2);
                    for (std::size_t v = 0; v < 2; ++v)
                        for (std::size_t u = 0; u < 2; ++u)
                            ASSERT_EQ(square.at[v][u], grid.at(x + static_cast<std::int64_t>(u),
                                                               y + static_cast<std::int64_t>(v)));
                }
        }
    }
}

TEST(UnitTree, is_the_typed_quadtree_where_nothing_is_kept_apart) {
    const UnitTree units{3, 64};
    const TypedQuadtree tree{3, 64};
    const TypeGrid a = units.types_of(0, -40, 12, 80, 80), b = tree.types_of(0, -40, 12, 80, 80);
    for (std::int64_t y = 12; y < 92; ++y)
        for (std::int64_t x = -40; x < 40; ++x) ASSERT_EQ(a.at(x, y), b.at(x, y));
}

}  // namespace
}  // namespace tessera
