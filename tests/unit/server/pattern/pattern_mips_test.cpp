#include "server/pattern/pattern_mips.h"

#include <gtest/gtest.h>

#include "shared/math/srgb.h"
#include "tests/support/made_patterns.h"

namespace tessera {
namespace {

TEST(PatternMips, ReturnLevelZeroOfOpaquePatternsBitForBit) {
    const PatternImages images = made_patterns(16, 5, 1, true);
    const PatternMips mips{images};
    const auto& codes = mips.codes(0).bytes;
    constexpr std::size_t blank_bytes = 16 * 16 * 4;
    ASSERT_EQ(codes.size(), images.codes.size() + blank_bytes);
    EXPECT_TRUE(std::equal(images.codes.begin(), images.codes.end(), codes.begin() + blank_bytes));
}

TEST(PatternMips, MultiplyColoursByAlpha) {
    PatternImages images{1, 1, 1, {255, 128, 0, 51}};
    const PatternMips mips{images};
    const float* values = mips.linear(0).row(mips.image(0, 0));
    EXPECT_FLOAT_EQ(values[0], 0.2F);
    EXPECT_FLOAT_EQ(values[1], from_srgb(128) * 0.2F);
    EXPECT_FLOAT_EQ(values[2], 0.0F);
    EXPECT_FLOAT_EQ(values[3], 0.2F);
}

TEST(PatternMips, ReduceEachPatternByItself) {
    const PatternImages images = made_patterns(8, 3, 2);
    const PatternMips mips{images};
    ASSERT_EQ(mips.side_log2(), 3);
    for (int level = 1; level <= 3; ++level) {
        // Images lie one below the other and their sides are even, so that halving all is halving each
        EXPECT_LT(difference_codes(mips.linear(level), halved(mips.linear(level - 1))), 1e-4);
    }
    for (std::int32_t pattern = 0; pattern < 3; ++pattern)
        for (std::int32_t slice = 0; slice < 2; ++slice) {
            const std::int32_t image = mips.image(pattern, slice);
            for (std::size_t channel = 0; channel < 4; ++channel)
                EXPECT_EQ(static_cast<float>(mips.mean(image)[channel]), mips.linear(3).row(image)[channel]);
        }
}

TEST(PatternMips, ShowNothingForPatternsAndSlicesThatThereAreNot) {
    const PatternMips mips{made_patterns(4, 3, 2)};
    for (const std::int32_t image : {mips.image(-1, 0), mips.image(3, 0), mips.image(0, 2), mips.image(0, -1),
                                     mips.first_image(0) - 1, mips.first_image(1) - 1}) {
        const std::uint8_t* codes = mips.codes(1).row(image * 2);
        EXPECT_TRUE(std::all_of(codes, codes + 2 * 2 * 4, [](std::uint8_t code) { return code == 0; }))
            << image;
    }
    EXPECT_EQ(mips.image(2, 1), mips.first_image(1) + 2);
    EXPECT_EQ(mips.images(), 2 * 4);
}

TEST(PatternMips, KeepAConstantPatternToTheLastBit) {
    PatternImages images{64, 1, 1, {}};
    for (int i = 0; i < 64 * 64; ++i) images.codes.insert(images.codes.end(), {17, 200, 3, 77});
    const PatternMips mips{images};
    for (int level = 0; level <= 6; ++level)
        for (std::size_t channel = 0; channel < 4; ++channel)
            EXPECT_EQ(mips.linear(level).row(mips.image(0, 0) << (6 - level))[channel],
                      mips.linear(0).row(mips.image(0, 0) << 6)[channel]);
}

}  // namespace
}  // namespace tessera
