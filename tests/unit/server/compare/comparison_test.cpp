#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/compare/comparison_sheet.h"
#include "server/compare/own_seams.h"
#include "server/quality/lab.h"
#include "tests/support/synthetic_asset.h"
#include "tests/unit/server/prepare/made_photo.h"

namespace tessera {
namespace {

TEST(OwnSeams, AreStepsBetweenTexelsThatWereNoNeighbours) {
    // Columns of a photograph that grow lighter by 4 codes; the right half is from 20 columns further on
    Rgb8Image image{8, 4, {}};
    std::vector<PhotoPoint> sources;
    for (std::int32_t y = 0; y < 4; ++y)
        for (std::int32_t x = 0; x < 8; ++x) {
            const std::int32_t from = x < 4 ? x : x + 20;
            sources.push_back({from, y});
            image.bytes.insert(image.bytes.end(), 3, static_cast<std::uint8_t>(80 + 4 * from));
        }
    const OwnSeams seams = measure_own_seams(image, sources, false);
    EXPECT_EQ(seams.pairs, 4U);
    const auto lightness = [](int code) {
        const auto c = static_cast<std::uint8_t>(code);
        const std::uint8_t codes[3] = {c, c, c};
        return double(lightness_of(codes));
    };
    // The other steps are three to the right in each half, of four rows, and none downwards
    const double right = lightness(92) - lightness(80) + lightness(188) - lightness(176);
    const double inside = right * 4 / (6 * 4 + 8 * 3);
    EXPECT_NEAR(seams.ratio.mean, (lightness(176) - lightness(92)) / inside, 0.2);
    const OwnSeams wrapped = measure_own_seams(image, sources, true);
    EXPECT_EQ(wrapped.pairs, 4U + 4U + 8U);
}

TEST(ComparisonSheet, HasARowForTheRepeatedTileAndOneForEachMethod) {
    std::vector<JudgedAsset> assets(2);
    assets[0].asset = tests::make_synthetic_asset({});
    assets[1].asset = tests::make_synthetic_interchange({});
    for (auto& judged : assets) {
        judged.texture = make_exchange_texture(judged.asset, {});
        judged.quality.repetition.levels.resize(1);
    }
    constexpr std::int32_t cell = 96;
    const auto sheet = draw_comparison("stones", assets, cell, {});
    ASSERT_TRUE(sheet);
    EXPECT_EQ(sheet->width, 3 * (cell + 8) + 8);
    const std::int32_t line = 7 + 16;
    EXPECT_EQ(sheet->height, 3 * (cell + line) + line + 8);
    // The last texel of a cell, where no words are
    const auto corner = [&](int row, int column) {
        return sheet->row(line + row * (cell + line) + line + cell - 1) +
               std::ptrdiff_t{4} * (8 + column * (cell + 8) + cell - 1);
    };
    const std::int32_t side = assets[0].asset.tile_side, at = (cell - 1) % side;
    EXPECT_EQ(corner(0, 0)[0], assets[0].asset.tile.bytes[std::size_t((at * side + at) * 3)]);
    for (int row = 1; row <= 2; ++row)
        for (int column = 0; column < 3; ++column) {
            Rgba8Image texel;
            ASSERT_TRUE(assets[std::size_t(row - 1)].texture->evaluate(
                {static_cast<std::uint8_t>(sheet_levels[column]), cell - 1, cell - 1, 1, 1},
                {.accuracy = Accuracy::exact}, texel));
            EXPECT_EQ(corner(row, column)[0], texel.bytes[0]) << row << ", " << column;
        }
}

TEST(ComparisonSheet, StopsWhenAsked) {
    std::vector<JudgedAsset> assets(1);
    assets[0].asset = tests::make_synthetic_asset({});
    assets[0].texture = make_exchange_texture(assets[0].asset, {});
    assets[0].quality.repetition.levels.resize(1);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_EQ(draw_comparison("stones", assets, 64, stop.get_token()).error().code, ErrorCode::cancelled);
}

TEST(JudgedAssets, ComeWithFiguresOfEveryKind) {
    SilentProgress silent;
    const auto judged = judge(test::made_photo(160, 160), {.tile_side = 64, .contents = 4}, silent);
    ASSERT_TRUE(judged) << judged.error().detail;
    EXPECT_EQ(judged->quality.gates.size(), 5U);
    EXPECT_GT(judged->quality.seams.pairs, 0U);
    EXPECT_GT(judged->own_seams.pairs, 0U);
    EXPECT_LT(judged->own_seams.ratio.mean, 3);
    EXPECT_LT(judged->quality.repetition.levels[0].greatest.value, 0.9);
    ASSERT_NE(judged->texture, nullptr);
}

}  // namespace
}  // namespace tessera
