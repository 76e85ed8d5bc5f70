#include "server/texture/kolar_choice.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/synthetic_asset.h"

namespace tessera {
namespace {

TEST(KolarChoice, DrawsByEquation1) {
    for (std::int64_t a = -40; a < 40; a += 7)
        for (std::int64_t b = -40; b < 40; b += 3) {
            const double x = double(a), y = double(b);
            const double sum = std::pow(0.3 + x + std::cos(y), 2) + std::pow(0.8 + y + std::sin(x), 2);
            EXPECT_NEAR(kolar_draw(0.3, 0.8, a, b), sum - std::floor(sum), 1e-9);
        }
}

TEST(KolarChoice, ShowsNoTwoPatchesThatOverlap) {
    const ExchangeAsset asset = tests::make_synthetic_interchange({.patches = 300, .blend_texels = 0});
    const Shapes shapes{asset, 0};
    const KolarChoice choice{asset, shapes, 4};
    std::size_t shown_at_all = 0;
    for (std::int64_t ty = -12; ty < 12; ++ty)
        for (std::int64_t tx = -12; tx < 12; ++tx) {
            const std::int32_t side = asset.tile_side;
            std::vector<bool> taken(std::size_t(9 * side * side));
            for (const Shown& shown : choice.shown_by(tx, ty)) {
                const Shapes::Shape& shape = shapes[shown.shape];
                EXPECT_EQ(asset.patches[shape.patch].set,
                          (tx + ty) % 2 == 0 ? ExchangeAsset::Set::a : ExchangeAsset::Set::b);
                ++shown_at_all;
                for (std::int32_t y = 0; y < shape.height; ++y)
                    for (const Shapes::Segment& segment : shapes.row(shape, y))
                        for (std::int32_t x = segment.begin; x < segment.end; ++x) {
                            const std::int32_t u = side * (1 + shown.tile_x) + shape.x + x;
                            const std::int32_t v = side * (1 + shown.tile_y) + shape.y + y;
                            ASSERT_FALSE(taken[std::size_t(v * 3 * side + u)]);
                            taken[std::size_t(v * 3 * side + u)] = true;
                        }
            }
        }
    EXPECT_GT(shown_at_all, 24u * 24 * 3);
}

TEST(KolarChoice, FarOutTheFormulaHasNoRandomBitLeft) {
    // Squares of coordinates fill a double: every patch is drawn alike, whatever its parameters. A reason for
    // the typed quadtree, whose integers know no distance.
    int near_draws = 0, far_draws = 0;
    for (std::int64_t i = 0; i < 1000; ++i) {
        const auto active = [&](std::int64_t x) {
            return kolar_draw(double(i) / 1000, 0.25, x + i, x - i) < 0.1;
        };
        near_draws += active(100);
        far_draws += active(std::int64_t{1} << 28);
    }
    EXPECT_NEAR(near_draws, 100, 40);
    EXPECT_EQ(far_draws, 1000);
}

}  // namespace
}  // namespace tessera
