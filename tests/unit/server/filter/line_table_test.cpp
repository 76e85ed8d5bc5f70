#include "server/filter/line_table.h"

#include <cstdio>

#include <gtest/gtest.h>

#include "server/filter/float_line_sums.h"
#include "tests/unit/server/filter/made_texels.h"

namespace tessera {
namespace {

TEST(LineTable, AveragesALinesSumsOverAnySlantedEdge) {
    const auto page = pages_of_image(noise_image(256, 256, 31), Beyond::repeat)->page(0, 0, 0, 0, {}).value();
    const LineTable<false> columns{*page};
    const LineTable<true> rows{*page};
    RandomFootprints random{32};
    for (int i = 0; i < 90; ++i) {
        const auto line = static_cast<std::size_t>(random.uniform() * 256);
        const double from = random.uniform() * 256, to = i % 3 == 0   ? from
                                                         : i % 3 == 1 ? from * 0.99
                                                                      : random.uniform() * 256;
        double column = 0, row = 0;
        constexpr int parts = 4000;
        for (int k = 0; k < parts; ++k) {
            const double at = from + (to - from) * (k + 0.5) / parts;
            const auto whole = static_cast<std::size_t>(at);
            const std::size_t l = line;
            for (std::size_t y = 0; y <= whole; ++y) {
                const double part = y < whole ? 1 : at - static_cast<double>(whole);
                column += part * page->steps[4 * (y * 256 + l)] / parts;
                row += part * page->steps[4 * (l * 256 + y)] / parts;
            }
            if (from == to && k == 0) {
                column *= parts;
                row *= parts;
                break;
            }
        }
        EXPECT_NEAR(columns.mean_sum(line, from, to)[0], column, 0.5);
        EXPECT_NEAR(rows.mean_sum(line, from, to)[0], row, 0.5);
    }
}

TEST(LineTable, ABrightestColumnOf65536TexelsBesideADarkOneIsExact) {
    LinearImage image{2, 1};
    constexpr float dark = 61.0F / 65535.0F;
    for (int c = 0; c < 4; ++c) {
        image.values[static_cast<std::size_t>(c)] = 1;
        image.values[static_cast<std::size_t>(4 + c)] = dark;
    }
    const auto lines = make_sampler({.kind = FilterKind::line_integral, .direction = LineDirection::vertical},
                                    pages_of_image(image, Beyond::repeat));
    double worst = 0;
    for (const double from : {0.0, 0.25, 0.75, 1.0})
        for (const double top : {-32768.0, 0.0, 100.5}) {
            const Footprint f = footprint_around(0, 0, {from + 0.5, top + 32768}, {1, 0}, {0, 65536});
            const double bright = 1 - from;
            const double truth = bright + (1 - bright) * static_cast<double>(dark);
            worst = std::max(worst, furthest(sample_one(*lines, f), {truth, truth, truth, truth}));
        }
    std::printf("65536 texels beside a dark column: %.6f codes at most\n", worst);
    EXPECT_LT(worst, 1e-4);  // The promise is 0.01
}

TEST(FloatLineSums, LoseWhatIntegersOfAPageKeepTheLongerAColumnIs) {
    EXPECT_LT(float_line_error(256), 0.001);
    EXPECT_GT(float_line_error(65536), 0.1);
    EXPECT_GT(float_line_error(1 << 20), float_line_error(4096));
    for (const std::int32_t length : {256, 4096, 65536, 1 << 20}) EXPECT_LT(integer_line_error(length), 1e-4);
}

}  // namespace
}  // namespace tessera
