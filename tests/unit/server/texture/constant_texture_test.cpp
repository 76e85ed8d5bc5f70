#include "server/texture/constant_texture.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tessera {
namespace {

LinearImage evaluated(const Texture& texture, const TexelRegion& region) {
    LinearImage image;
    EXPECT_TRUE(texture.evaluate(region, Budget{}, image).has_value());
    return image;
}

TEST(ConstantTexture, IsTheSameBytesEverywhere) {
    const auto texture = make_constant_texture({10, 130, 255, 255});
    for (std::uint8_t level = 0; level <= 30; ++level) {
        Rgba8Image page;
        ASSERT_TRUE(texture->evaluate({level, -5, std::int64_t{1} << 37, 9, 7}, Budget{}, page).has_value());
        for (std::size_t i = 0; i < page.bytes.size(); i += 4) {
            ASSERT_EQ(page.bytes[i], 10);
            ASSERT_EQ(page.bytes[i + 1], 130);
            ASSERT_EQ(page.bytes[i + 2], 255);
            ASSERT_EQ(page.bytes[i + 3], 255);
        }
    }
}

TEST(CheckerTexture, HasItsFirstColourAtTheOrigin) {
    const auto texture = make_checker_texture(3, {255, 255, 255, 255}, {0, 0, 0, 255});
    const LinearImage image = evaluated(*texture, {0, -6, -6, 12, 12});
    for (std::int64_t y = -6; y < 6; ++y)
        for (std::int64_t x = -6; x < 6; ++x) {
            const auto cell = [](std::int64_t a) { return a < 0 ? (a - 2) / 3 : a / 3; };
            const bool first = ((cell(x) + cell(y)) & 1) == 0;
            EXPECT_EQ(image.row(static_cast<std::int32_t>(y + 6))[4 * (x + 6)], first ? 1.0F : 0.0F)
                << x << ", " << y;
        }
}

TEST(CheckerTexture, IsTheReductionOfItsChildrenForAnyCell) {
    for (const std::int64_t cell : {1, 3, 7, 32, 100, 1 << 20})
        for (std::uint8_t level = 1; level <= 30; ++level)
            for (const std::int64_t at :
                 {std::int64_t{0}, std::int64_t{-17}, (std::int64_t{1} << (38 - level)) - 5}) {
                const auto texture = make_checker_texture(cell, {255, 200, 0, 255}, {0, 10, 99, 128});
                const LinearImage page = evaluated(*texture, {level, at, at, 12, 12});
                const LinearImage below =
                    evaluated(*texture, {static_cast<std::uint8_t>(level - 1), 2 * at, 2 * at, 24, 24});
                for (std::int32_t y = 0; y < 12; ++y)
                    for (std::int32_t x = 0; x < 48; ++x) {
                        const std::int32_t left = x / 4 * 8 + x % 4;
                        const float mean =
                            0.25F * (below.row(2 * y)[left] + below.row(2 * y)[left + 4] +
                                     below.row(2 * y + 1)[left] + below.row(2 * y + 1)[left + 4]);
                        ASSERT_NEAR(page.row(y)[x], mean, 1e-6) << "cell " << cell << " level " << int{level};
                    }
            }
}

}  // namespace
}  // namespace tessera
