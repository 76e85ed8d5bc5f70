#include "server/filter/parallelogram.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "server/filter/turning.h"

namespace tessera {
namespace {

struct Image {
    std::int32_t width, height;
    std::vector<double> texels;

    double held(std::int32_t x, std::int32_t y) const {
        return texels[std::size_t(std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1))];
    }
    /// The surface that the header describes.
    double at(double x, double y) const {
        if (x < 0 || y < 0 || x > width || y > height) return 0;
        const double u = x - 0.5, v = y - 0.5;
        const auto i = static_cast<std::int32_t>(std::floor(u)), j = static_cast<std::int32_t>(std::floor(v));
        const double fu = u - i, fv = v - j;
        return (held(i, j) * (1 - fu) + held(i + 1, j) * fu) * (1 - fv) +
               (held(i, j + 1) * (1 - fu) + held(i + 1, j + 1) * fu) * fv;
    }
};

double integral(const Image& image, const Parallelogram& f) {
    FootprintTaps taps{image.width, image.height};
    double sum = 0;
    for (const Tap& tap : taps.of(f)) sum += tap.weight * image.texels[std::size_t(tap.texel)];
    return sum;
}

double supersampled(const Image& image, const Parallelogram& f, int n) {
    double sum = 0;
    for (int b = 0; b < n; ++b)
        for (int a = 0; a < n; ++a) {
            const double s = (a + 0.5) / n, t = (b + 0.5) / n;
            sum += image.at(f.x + s * f.along_x + t * f.across_x, f.y + s * f.along_y + t * f.across_y);
        }
    return sum * std::abs(f.along_x * f.across_y - f.along_y * f.across_x) / (double(n) * n);
}

Image noise(std::int32_t width, std::int32_t height, unsigned seed) {
    std::mt19937 random{seed};
    Image image{width, height, {}};
    for (std::int32_t k = 0; k < width * height; ++k) image.texels.push_back(double(random() % 1000) / 999);
    return image;
}

TEST(FootprintTaps, AgreeWithDenseSupersampling) {
    std::mt19937 random{11};
    const auto uniform = [&](double from, double to) {
        return from + (to - from) * double(random()) / 4294967295.0;
    };
    for (int trial = 0; trial < 60; ++trial) {
        const Image image =
            noise(1 + std::int32_t(random() % 9), 1 + std::int32_t(random() % 9), unsigned(random()));
        const Parallelogram f{uniform(-3, 10), uniform(-3, 10), uniform(-5, 5),
                              uniform(-5, 5),  uniform(-5, 5),  uniform(-5, 5)};
        EXPECT_NEAR(integral(image, f), supersampled(image, f, 700), 0.02) << trial;
    }
}

TEST(FootprintTaps, OfAConstantGiveTheAreaInsideTheImage) {
    const Image one{6, 4, std::vector<double>(24, 1.0)};
    // Inside
    EXPECT_NEAR(integral(one, {1, 1, 2, 0.5, -0.5, 1}), 2.25, 1e-14);
    // Half out over the left border
    EXPECT_NEAR(integral(one, {-1, 1, 2, 0, 0, 1}), 1.0, 1e-14);
    // All of the image inside a large footprint
    EXPECT_NEAR(integral(one, {-50, -60, 100, 20, -20, 100}), 24.0, 1e-12);
    // A diamond around the corner (0, 0): a quarter of its area of 2
    EXPECT_NEAR(integral(one, {-1, 0, 1, 1, 1, -1}), 0.5, 1e-14);
    // Either orientation
    EXPECT_NEAR(integral(one, {1, 1, -0.5, 1, 2, 0.5}), 2.25, 1e-14);
}

TEST(FootprintTaps, OfALinearRampGiveItsValueAtTheMiddle) {
    Image ramp{20, 20, {}};
    for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 20; ++x) ramp.texels.push_back(0.3 + 0.7 * (x + 0.5) - 0.2 * (y + 0.5));
    for (int k = 0; k < 64; ++k) {
        const Turning t = turning(k / 64.0);
        const double side = 0.3 + 0.08 * k, middle_x = 9.7, middle_y = 10.2;
        const double ax = side * t.cosine, ay = side * t.sine, bx = -side * t.sine, by = side * t.cosine;
        const Parallelogram f{middle_x - (ax + bx) / 2, middle_y - (ay + by) / 2, ax, ay, bx, by};
        EXPECT_NEAR(integral(ramp, f), (0.3 + 0.7 * middle_x - 0.2 * middle_y) * side * side, 1e-11);
    }
}

TEST(FootprintTaps, OfAProductOfRampsGiveItsClosedForm) {
    // x·y is bilinear: the surface is exact between the outermost centres
    Image product{12, 12, {}};
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 12; ++x) product.texels.push_back((x + 0.5) * (y + 0.5));
    // ∫∫ xy over [2.3, 7.9] × [1.1, 9.4]
    const double expected = (7.9 * 7.9 - 2.3 * 2.3) / 2 * (9.4 * 9.4 - 1.1 * 1.1) / 2;
    EXPECT_NEAR(integral(product, {2.3, 1.1, 5.6, 0, 0, 8.3}), expected, 1e-9);
}

TEST(FootprintTaps, OfAGridOfFootprintsSumToThoseOfTheWhole) {
    const Image image = noise(16, 16, 5);
    const Turning t = turning(0.07);
    double sum = 0;
    for (int b = 0; b < 9; ++b)
        for (int a = 0; a < 9; ++a)
            sum += integral(image,
                            {-2 + 2.1 * (a * t.cosine - b * t.sine), 1 + 2.1 * (a * t.sine + b * t.cosine),
                             2.1 * t.cosine, 2.1 * t.sine, -2.1 * t.sine, 2.1 * t.cosine});
    const double whole = 9 * 2.1;
    EXPECT_NEAR(sum,
                integral(image, {-2, 1, whole * t.cosine, whole * t.sine, -whole * t.sine, whole * t.cosine}),
                1e-11);
}

TEST(FootprintTaps, AreNoneWhereNothingIsMet) {
    FootprintTaps taps{8, 8};
    EXPECT_TRUE(taps.of({1, 1, 0, 0, 3, 1}).empty());
    EXPECT_TRUE(taps.of({1, 1, 2, 2, 3, 3}).empty());
    EXPECT_TRUE(taps.of({100, 1, 2, 0, 0, 2}).empty());
    EXPECT_TRUE(taps.of({1, -1e12, 2, 0, 0, 2}).empty());
    EXPECT_TRUE(taps.of({8, 0, 2, 0, 0, 2}).empty());
    EXPECT_TRUE(taps.of({std::numeric_limits<double>::quiet_NaN(), 1, 2, 0, 0, 2}).empty());
    EXPECT_TRUE(taps.of({1, 1, std::numeric_limits<double>::infinity(), 0, 0, 2}).empty());
    EXPECT_FALSE(taps.of({7, 7, 2, 0, 0, 2}).empty());
}

}  // namespace
}  // namespace tessera
