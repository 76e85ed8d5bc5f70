#include "client/render/held_map.h"

#include <random>

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(HeldMap, EverySpriteLiesInAtMostFourCellsAndInAllThatItsCircleMeets) {
    std::mt19937 random{3};
    std::uniform_real_distribution<double> place{-5000, 5000}, size{1, 300};
    for (int round = 0; round < 50; ++round) {
        std::vector<HeldReach> sprites;
        for (int i = 0; i < 1 + round; ++i) sprites.push_back({place(random), place(random), size(random)});
        const HeldMap map = HeldMap::of(sprites);
        ASSERT_LE(map.columns, HeldMap::most_side);
        ASSERT_LE(map.rows, HeldMap::most_side);
        std::vector<int> cells(sprites.size());
        for (const std::uint16_t index : map.cells)
            if (index != 0) ++cells[index - 1u];
        const auto area = static_cast<std::size_t>(map.columns * map.rows);
        for (std::size_t i = 0; i < sprites.size(); ++i) {
            EXPECT_LE(cells[i], 4);
            // Wherever the sprite may colour a texel, that texel's cell lists it
            for (int sample = 0; sample < 50; ++sample) {
                std::uniform_real_distribution<double> part{-1, 1};
                const double x = sprites[i].x + part(random) * sprites[i].radius,
                             y = sprites[i].y + part(random) * sprites[i].radius;
                const auto column = static_cast<int>((x - map.low_x) / map.cell),
                           row = static_cast<int>((y - map.low_y) / map.cell);
                bool listed = false;
                for (int layer = 0; layer < map.layers; ++layer)
                    listed =
                        listed || map.cells[static_cast<std::size_t>(layer) * area +
                                            static_cast<std::size_t>(row * map.columns + column)] == i + 1;
                EXPECT_TRUE(listed);
            }
        }
    }
}

TEST(HeldMap, LayersKeepTheOrderOfDrawing) {
    const std::vector<HeldReach> sprites{{0, 0, 10}, {1, 0, 10}, {2, 0, 10}};
    const HeldMap map = HeldMap::of(sprites);
    EXPECT_EQ(map.layers, 3);
    const auto area = static_cast<std::size_t>(map.columns * map.rows);
    for (std::size_t layer = 0; layer < 3; ++layer) EXPECT_EQ(map.cells[layer * area], layer + 1);
}

TEST(HeldMap, TellsHowManyACellHasNoLayerLeftFor) {
    // One stands alone, the others on one spot
    std::vector<HeldReach> sprites{{500, 500, 10}};
    for (int i = 0; i < HeldMap::most_layers; ++i) sprites.push_back({0, 0, 10});
    EXPECT_EQ(HeldMap::of(sprites).hidden, 0u);
    for (std::size_t more = 1; more <= 3; ++more) {
        sprites.push_back({0, 0, 10});
        const HeldMap map = HeldMap::of(sprites);
        EXPECT_EQ(map.hidden, more);
        EXPECT_EQ(map.layers, HeldMap::most_layers);
    }
}

TEST(HeldMap, OfNothingIsNothing) { EXPECT_EQ(HeldMap::of({}).layers, 0); }

}  // namespace
}  // namespace tessera
