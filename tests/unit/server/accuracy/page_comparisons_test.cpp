#include "server/accuracy/page_comparisons.h"

#include <gmock/gmock.h>

#include "server/accuracy/measured_texture.h"
#include "tests/support/synthetic_asset.h"

namespace tessera {
namespace {

TEST(CompareLight, CodesDarkenAndLightDoesNot) {
    std::vector<proto::PageRow> rows;
    compare_light("checker", *checker_texture().image, rows);
    ASSERT_EQ(rows.size(), 12u);
    for (const proto::PageRow& row : rows) {
        if (row.setting() == "linear light") {
            EXPECT_EQ(row.mse(), 0);
        }
        // A board's grey is 188 in codes of light and 127.5 as a mean of codes: seen as soon as squares meet
        if (row.setting() == "sRGB codes" && row.level() == 6) {
            EXPECT_NEAR(row.mse(), 60.1 * 60.1, 80);
        }
        if (row.setting() == "sRGB codes" && row.level() <= 5) {
            EXPECT_LT(row.mse(), 1e-6);
        }
    }
}

TEST(CompareContentDepth, SixteenBitsStayBelowAHundredthOfACode) {
    std::vector<proto::PageRow> rows;
    compare_content_depth("text", *text_texture().image, rows);
    for (const proto::PageRow& row : rows) {
        if (row.setting() == "16-bit linear") {
            EXPECT_LT(row.max_error(), 0.02) << row.level();
        }
        if (row.setting() == "8-bit sRGB") {
            EXPECT_GT(row.max_error(), 0.5) << row.level();
        }
    }
}

TEST(CompareIntegrals, IntegersAreExactAtEveryLengthAndFloatsAreNot) {
    std::vector<proto::PageRow> rows;
    compare_integrals(rows);
    for (const proto::PageRow& row : rows) {
        if (row.setting() == "modular integer sums") {
            EXPECT_LT(row.max_error(), 1e-4) << row.level();
        }
        if (row.setting() == "32-bit float sums" && row.level() == 22) {
            EXPECT_GT(row.max_error(), 0.5);
        }
    }
}

TEST(CompareStatistics, KeepsWhatItPromises) {
    std::vector<proto::PageRow> rows;
    const ExchangeAsset asset = tests::make_synthetic_asset({.tile_side = 32, .patches = 8, .contents = 3});
    ASSERT_TRUE(compare_statistics(asset, {}, rows));
    int typed = 0;
    for (const proto::PageRow& row : rows) {
        if (row.confidence() >= 1) {
            EXPECT_LE(row.max_error(), row.bound_codes() + 0.03) << row.setting();
        }
        if (row.setting() == "typed choices exact" || row.setting() == "exact") ++typed;
    }
    EXPECT_GT(rows.size(), 12u);
    EXPECT_GT(typed, 4);
}

}  // namespace
}  // namespace tessera
