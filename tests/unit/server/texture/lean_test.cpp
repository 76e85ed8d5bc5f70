#include "server/texture/lean.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace tessera {
namespace {

using Three = std::array<float, 3>;

/// The mean of an image's texels, as an evaluator gives it.
Three mean_of(const Rgb16Image& image) {
    std::array<double, 3> sum{};
    const std::size_t count = image.values.size() / 3;
    for (std::size_t i = 0; i < image.values.size(); ++i) sum[i % 3] += image.values[i] / 65535.0;
    Three mean;
    for (std::size_t c = 0; c < 3; ++c) mean[c] = static_cast<float>(sum[c] / double(count));
    return mean;
}

LeanTexel texel_of(const Rgb8Image& normals, double range) {
    return lean_texel(mean_of(lean_slopes(normals, range, nullptr)).data(),
                      mean_of(lean_squares(normals, range)).data(),
                      mean_of(lean_products(normals, range, nullptr)).data(), range);
}

TEST(Lean, SlopesAreThoseOfTheNormalWhateverItsLength) {
    const Slopes slopes = slopes_of(191, 64, 255);
    EXPECT_NEAR(slopes.x, 127.0 / 255, 1e-12);
    EXPECT_NEAR(slopes.y, -127.0 / 255, 1e-12);
    EXPECT_NEAR(slopes_of(143, 128, 143).x, 1, 1e-12);
}

TEST(Lean, LaysDownWhatIsTooSteepAndKeepsItsDirection) {
    for (const int blue : {0, 100, 127, 128}) {
        const Slopes slopes = slopes_of(255, 64, static_cast<std::uint8_t>(blue));
        EXPECT_DOUBLE_EQ(slopes.x, steepest_slope) << blue;
        EXPECT_NEAR(slopes.y, steepest_slope * -127 / 255, 1e-12) << blue;
    }
}

TEST(Lean, AFlatSurfaceHasExactlyNoVarianceWhateverItsNormalAndRange) {
    for (int red = 0; red < 256; red += 5)
        for (int green = 0; green < 256; green += 15)
            for (const double more : {1.0, 1.7, 40.0}) {
                const Rgb8Image flat{
                    1, 1, {static_cast<std::uint8_t>(red), static_cast<std::uint8_t>(green), 200}};
                const LeanTexel texel = texel_of(flat, steepest_in(flat) * more);
                EXPECT_EQ(texel.trace, 0) << red << ' ' << green << ' ' << more;
                EXPECT_EQ(texel.variance_x, 0) << red << ' ' << green << ' ' << more;
                EXPECT_EQ(texel.variance_y, 0) << red << ' ' << green << ' ' << more;
                EXPECT_EQ(texel.covariance, 0) << red << ' ' << green << ' ' << more;
            }
}

TEST(Lean, TheCovarianceOfARidgeIsThatOfItsTwoSlopes) {
    // Up on one side and down on the other, along the diagonal
    const Rgb8Image ridge{2, 1, {191, 191, 255, 64, 64, 255}};
    const LeanTexel texel = texel_of(ridge, 2.0);
    const double square = std::pow(127.0 / 255, 2);
    EXPECT_NEAR(texel.mean.x, 0, 1e-4);
    EXPECT_NEAR(texel.variance_x, square, 1e-4);
    EXPECT_NEAR(texel.variance_y, square, 1e-4);
    EXPECT_NEAR(texel.covariance, square, 2e-4);
}

TEST(Lean, IsNeverFurtherOffThanItSays) {
    // Two slopes each, all over the range: against their variance in doubles
    const double range = 2.0;
    const LeanError error = lean_error(6e-8, range);
    EXPECT_LT(error.trace, range * range * 2.5e-6);
    EXPECT_LT(error.variance, range * range * 1.2 / 65535);
    for (int a = 60; a < 200; ++a)
        for (int b = 60; b < 200; b += 7) {
            const Rgb8Image two{
                2, 1, {static_cast<std::uint8_t>(a), 60, 255, static_cast<std::uint8_t>(b), 140, 255}};
            const Slopes first = slopes_of(two.bytes[0], 60, 255), second = slopes_of(two.bytes[3], 140, 255);
            const double dx = (first.x - second.x) / 2, dy = (first.y - second.y) / 2;
            const LeanTexel texel = texel_of(two, range);
            // A slope's own rounding is within half a step of 1/32767 of the range
            EXPECT_NEAR(texel.trace, dx * dx + dy * dy,
                        error.trace + 4 * (std::abs(dx) + std::abs(dy)) * range / 65534);
            EXPECT_NEAR(texel.variance_x, dx * dx, error.variance + 4 * std::abs(dx) * range / 65534)
                << a << ' ' << b;
            EXPECT_NEAR(texel.covariance, dx * dy, error.covariance + 4 * range / 65534) << a << ' ' << b;
        }
}

TEST(Lean, EveryRoughnessSurvivesItsWayThroughTheSquareOfAlpha) {
    for (int code = 0; code < 256; ++code) {
        const Rgb8Image image{1, 1, {static_cast<std::uint8_t>(code), 0, 0}};
        const double squared = squared_alpha(mean_of(squared_alphas(image, nullptr)).data());
        EXPECT_NEAR(squared, std::pow(code / 255.0, 4), 1e-7 * squared) << code;
        EXPECT_EQ(std::lround(255 * rougher(squared, {})), code);
    }
}

TEST(Lean, AddsTwiceTheMeanVarianceToTheSquareOfAlpha) {
    const LeanTexel bumpy{{0.3, 0.1}, 0.08, 0.02, 0.06, 0.01};
    const double roughness = rougher(0.01, bumpy);
    EXPECT_NEAR(std::pow(roughness, 4), 0.01 + 2 * (0.02 + 0.06) / 2, 1e-12);
    EXPECT_EQ(rougher(0.9, {{}, 2.0, 1.0, 1.0, 0}), 1.0);
}

TEST(Lean, CarriesAThirdImageAsItIs) {
    const Rgb8Image normal{1, 1, {128, 128, 255}}, height{1, 1, {77, 1, 2}};
    EXPECT_EQ(lean_slopes(normal, 1.0, &height).values[2], 77 * 257);
    EXPECT_EQ(squared_alphas(normal, &height).values[2], 77 * 257);
}

}  // namespace
}  // namespace tessera
