#include "server/texture/patch_map.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_asset.h"

namespace tessera {
namespace {

class PatchMapTest : public testing::TestWithParam<std::int32_t> {
  protected:
    const ExchangeAsset asset_ =
        tests::make_synthetic_asset({.tile_side = 64, .patches = 12, .blend_texels = 2 * GetParam()});
    const PatchMap map_{asset_, GetParam()};

    std::uint32_t weight(const PatchMap::Patch& patch, std::int32_t x, std::int32_t y) const {
        const std::int32_t in_x = (x - patch.x) & 63, in_y = (y - patch.y) & 63;
        return in_x < patch.width && in_y < patch.height
                   ? patch.weights[std::size_t(in_y * patch.width + in_x)]
                   : 0u;
    }
};

TEST_P(PatchMapTest, WeightsSumToExactlyOneAtEveryTexel) {
    for (std::int32_t y = 0; y < 64; ++y)
        for (std::int32_t x = 0; x < 64; ++x) {
            std::uint32_t sum = 0;
            for (const auto& patch : map_.patches()) sum += weight(patch, x, y);
            ASSERT_EQ(sum, PatchMap::weight_one) << x << ", " << y;
        }
}

TEST_P(PatchMapTest, APatchHasAllTheWeightFarFromItsBorder) {
    const std::int32_t r = GetParam();
    int inside = 0;
    for (std::int32_t y = 0; y < 64; ++y)
        for (std::int32_t x = 0; x < 64; ++x) {
            const std::uint16_t label = asset_.labels[std::size_t(y * 64 + x)];
            bool alone = true;
            for (std::int32_t dy = -r; dy <= r; ++dy)
                for (std::int32_t dx = -r; dx <= r; ++dx)
                    alone &= asset_.labels[std::size_t(((y + dy) & 63) * 64 + ((x + dx) & 63))] == label;
            if (!alone) continue;
            ++inside;
            ASSERT_EQ(weight(map_.patches()[label], x, y), PatchMap::weight_one);
        }
    EXPECT_GT(inside, 100);
}

TEST_P(PatchMapTest, ASpanOfALevelCoversAllThatTheLevelBelowCovers) {
    // The OR-reduction of Lutz et al. 2019, section 4.1
    for (std::size_t level = 0; level + 1 < map_.levels().size(); ++level) {
        const auto& fine = map_.levels()[level];
        const auto& coarse = map_.levels()[level + 1];
        for (std::int32_t y = 0; y < 2 * fine.side; ++y)
            for (const auto& span : fine.row(y)) {
                bool covered = false;
                for (const auto& above : coarse.row(y / 2))
                    covered |= above.patch == span.patch && above.begin <= span.begin / 2 &&
                               above.end > (span.end - 1) / 2;
                ASSERT_TRUE(covered) << "level " << level << " row " << y << " patch " << span.patch;
            }
    }
}

TEST_P(PatchMapTest, APatchOverTheBorderKeepsOneIdentity) {
    int over = 0;
    for (const auto& patch : map_.patches()) {
        EXPECT_LE(patch.width, map_.side());
        EXPECT_LE(patch.height, map_.side());
        over += patch.x + patch.width > map_.side() || patch.y + patch.height > map_.side();
    }
    EXPECT_GT(over, 0) << "the asset has no patch to test this with";
    // One span in the doubled row, never one on each side
    for (std::int32_t y = 0; y < 128; ++y) {
        std::vector<int> seen(map_.patches().size());
        for (const auto& span : map_.levels()[0].row(y)) ASSERT_EQ(++seen[span.patch], 1);
    }
}

INSTANTIATE_TEST_SUITE_P(Radii, PatchMapTest, testing::Values(0, 1, 4));

}  // namespace
}  // namespace tessera
