#include "server/prepare/perceptual.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

PerceptualColor color_of(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
    return to_perceptual({1, 1, {red, green, blue}}).colors.front();
}

TEST(Perceptual, agrees_with_published_cielab_values_within_half_a_unit) {
    // Colour, L*, a*, b* under D65 (Lindbloom's calculator)
    struct Row {
        std::uint8_t red, green, blue;
        double lightness, green_red, blue_yellow;
    };
    for (const Row& row : {Row{255, 255, 255, 100, 0, 0}, Row{0, 0, 0, 0, 0, 0},
                           Row{119, 119, 119, 50.03, 0, 0}, Row{255, 0, 0, 53.24, 80.09, 67.20},
                           Row{0, 255, 0, 87.73, -86.18, 83.18}, Row{0, 0, 255, 32.30, 79.19, -107.86}}) {
        const PerceptualColor color = color_of(row.red, row.green, row.blue);
        EXPECT_NEAR(color.lightness / 8.0, row.lightness, 0.5);
        EXPECT_NEAR(color.green_red / 8.0, row.green_red, 0.5);
        EXPECT_NEAR(color.blue_yellow / 8.0, row.blue_yellow, 0.5);
    }
}

TEST(Perceptual, every_step_of_grey_is_seen) {
    for (int code = 1; code < 256; ++code) {
        const auto at = [](int c) { return color_of(std::uint8_t(c), std::uint8_t(c), std::uint8_t(c)); };
        EXPECT_GT(at(code).lightness, at(code - 1).lightness) << "at code " << code;
    }
}

TEST(Perceptual, reducing_takes_the_mean_of_whole_blocks_only) {
    const PerceptualImage image{5,
                                2,
                                {{8, 0, 0},
                                 {16, 4, 0},
                                 {1, 1, 1},
                                 {1, 1, 1},
                                 {99, 99, 99},
                                 {24, 0, -8},
                                 {32, 4, 0},
                                 {1, 1, 1},
                                 {1, 1, 1},
                                 {99, 99, 99}}};
    const PerceptualImage half = reduced(image, 2);
    ASSERT_EQ(half.width, 2);
    ASSERT_EQ(half.height, 1);
    EXPECT_EQ(half.colors[0], (PerceptualColor{20, 2, -2}));
    EXPECT_EQ(half.colors[1], (PerceptualColor{1, 1, 1}));
}

}  // namespace
}  // namespace tessera
