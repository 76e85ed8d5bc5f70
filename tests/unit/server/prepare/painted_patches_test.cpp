#include "server/prepare/painted_patches.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::HasSubstr;

constexpr std::int32_t side = 16;

/// Sixteen squares of 4, moved by 2, so that those of the last row and column wrap.
std::vector<std::uint16_t> squares() {
    std::vector<std::uint16_t> map;
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            map.push_back(static_cast<std::uint16_t>(1000 + (y + 2) % side / 4 * 40 + (x + 2) % side / 4));
    return map;
}

TEST(PaintedPatches, AreOneForEachLabelAlsoAcrossTheBorder) {
    const auto painted = painted_patches(squares(), side);
    ASSERT_TRUE(painted) << painted.error().detail;
    ASSERT_EQ(painted->patches.size(), 16u);
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) {
            const std::uint16_t label = painted->labels[std::size_t(y * side + x)];
            ASSERT_LT(label, 16);
            const auto& patch = painted->patches[label];
            EXPECT_EQ(patch.width, 4);
            EXPECT_EQ(patch.height, 4);
            EXPECT_LT((x - patch.x) & (side - 1), 4);
            EXPECT_LT((y - patch.y) & (side - 1), 4);
        }
    EXPECT_EQ(painted->labels[0], 0) << "numbered from the top";
    EXPECT_EQ(painted->patches[0].x, 14);
    EXPECT_EQ(painted->patches[0].y, 14);
}

TEST(PaintedPatches, ALabelInPiecesIsNamedWithBothPlaces) {
    auto map = squares();
    map[5 * side + 9] = 1000;
    EXPECT_THAT(
        painted_patches(map, side).error().detail,
        HasSubstr(
            "the patch map's label 1000 is in pieces, one at texel (0, 0) and another at texel (9, 5); join "
            "them, or give each a grey of its own"));
}

TEST(PaintedPatches, ALabelWiderThanHalfTheTileIsNamed) {
    auto map = squares();
    for (std::int32_t x = 2; x < 11; ++x) map[3 * side + std::size_t(x)] = 7;
    EXPECT_THAT(painted_patches(map, side).error().detail,
                HasSubstr("label 7 at texel (2, 3) is 9×1 texels; at most 8, half the tile, so divide it"));
    // All round the torus
    const std::vector<std::uint16_t> one(side * side, 3);
    EXPECT_THAT(painted_patches(one, side).error().detail, HasSubstr("label 3 at texel (0, 0) is"));
}

}  // namespace
}  // namespace tessera
