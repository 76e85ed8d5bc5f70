#include "server/prepare/graph_cut.h"

#include <gtest/gtest.h>

#include "shared/math/hash.h"

namespace tessera {
namespace {

std::uint32_t below(std::uint64_t& bits, std::uint32_t most) {
    bits = mix(bits + 1);
    return uniform_below(bits, most);
}

/// Prices so low that many shapes are equally cheap.
CutGrid grid_at_random(std::int32_t width, std::int32_t height, std::uint64_t seed) {
    std::uint64_t bits = mix(seed);
    CutGrid grid{width, height};
    const std::uint32_t most = 1 + below(bits, 9);
    for (std::size_t i = 0; i < grid.right.size(); ++i) {
        grid.right[i] = below(bits, most);
        grid.below[i] = below(bits, most);
        grid.outside[i] = below(bits, 5) == 0 ? CutGrid::must : below(bits, most + 2);
        grid.inside[i] =
            grid.outside[i] != CutGrid::must && below(bits, 5) == 0 ? CutGrid::must : below(bits, most + 2);
    }
    return grid;
}

std::uint64_t cost_of(const CutGrid& grid, std::uint32_t shape) {
    std::uint64_t cost = 0;
    const auto in = [&](std::size_t i) { return (shape >> i & 1) != 0; };
    for (std::int32_t y = 0; y < grid.height; ++y)
        for (std::int32_t x = 0; x < grid.width; ++x) {
            const std::size_t i = grid.index(x, y);
            cost += in(i) ? grid.inside[i] : grid.outside[i];
            if (x + 1 < grid.width && in(i) != in(i + 1)) cost += grid.right[i];
            if (y + 1 < grid.height && in(i) != in(grid.index(x, y + 1))) cost += grid.below[i];
        }
    return cost;
}

TEST(GraphCut, finds_the_cheapest_of_all_shapes_and_of_these_the_smallest) {
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        const std::int32_t width = 1 + static_cast<std::int32_t>(seed % 4);
        const std::int32_t height = 1 + static_cast<std::int32_t>(seed / 4 % 3);
        const CutGrid grid = grid_at_random(width, height, seed);
        std::uint64_t cheapest = ~std::uint64_t{0};
        std::uint32_t common = 0;  // of all cheapest shapes: itself one, since costs are submodular
        for (std::uint32_t shape = 0; shape < std::uint32_t{1} << width * height; ++shape) {
            const std::uint64_t cost = cost_of(grid, shape);
            if (cost < cheapest) common = ~std::uint32_t{0};
            cheapest = std::min(cheapest, cost);
            if (cost == cheapest) common &= shape;
        }
        const ShapeCut cut = cheapest_shape(grid);
        std::uint32_t found = 0;
        for (std::int32_t y = 0; y < height; ++y)
            for (std::int32_t x = 0; x < width; ++x)
                if (cut.shape.at(x, y)) found |= std::uint32_t{1} << grid.index(x, y);
        ASSERT_EQ(cut.cost, cheapest) << "seed " << seed;
        ASSERT_EQ(found, common) << "seed " << seed;
    }
}

TEST(GraphCut, goes_through_the_gap_in_a_wall) {
    // Left is in, right is out; borders are dear but at column 5, which a texel in the middle row moves to 7
    CutGrid grid{12, 9};
    for (std::int32_t y = 0; y < 9; ++y) {
        grid.outside[grid.index(0, y)] = CutGrid::must;
        grid.inside[grid.index(11, y)] = CutGrid::must;
        for (std::int32_t x = 0; x < 12; ++x) {
            grid.right[grid.index(x, y)] = x == (y == 4 ? 7 : 5) ? 1 : 1000;
            grid.below[grid.index(x, y)] = 1;
        }
    }
    const ShapeCut cut = cheapest_shape(grid);
    EXPECT_EQ(cut.cost, 9u + 4);
    for (std::int32_t y = 0; y < 9; ++y)
        for (std::int32_t x = 0; x < 12; ++x)
            EXPECT_EQ(cut.shape.at(x, y), x <= (y == 4 ? 7 : 5)) << x << ", " << y;
}

TEST(GraphCut, takes_the_highest_prices_without_overflow) {
    constexpr std::uint32_t highest = std::uint32_t{1} << 24;
    CutGrid grid{40, 40};
    for (std::size_t i = 0; i < grid.right.size(); ++i)
        grid.right[i] = grid.below[i] = grid.outside[i] = highest;
    for (std::int32_t y = 0; y < 40; ++y) grid.inside[grid.index(39, y)] = CutGrid::must;
    const ShapeCut cut = cheapest_shape(grid);
    EXPECT_EQ(cut.cost, std::uint64_t{80} * highest);  // the column that is out, and the border to it
    for (std::int32_t y = 0; y < 40; ++y) EXPECT_TRUE(cut.shape.at(38, y));
}

TEST(GraphCut, with_every_texel_forced_is_what_was_forced) {
    CutGrid grid{3, 1};
    grid.outside[1] = CutGrid::must;
    grid.inside[0] = grid.inside[2] = CutGrid::must;
    grid.right = {5, 7, 0};
    const ShapeCut cut = cheapest_shape(grid);
    EXPECT_EQ(cut.cost, 12u);
    EXPECT_TRUE(cut.shape.at(1, 0));
    EXPECT_FALSE(cut.shape.at(0, 0) || cut.shape.at(2, 0));
}

}  // namespace
}  // namespace tessera
