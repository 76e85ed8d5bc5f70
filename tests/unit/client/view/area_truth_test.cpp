#include "client/view/area_truth.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "shared/math/hash.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

constexpr std::int32_t side = 64;

Rgba8Image noise() {
    Rgba8Image image{side, side};
    for (std::size_t at = 0; at < image.bytes.size(); ++at)
        image.bytes[at] = at % 4 == 3 ? 255 : static_cast<std::uint8_t>(hash(9, stream("noise"), at, 0));
    return image;
}

/// 256 × 256 points of the quadrilateral, bilinearly spaced and weighted by the area that each stands for.
std::array<double, 3> sampled(const Rgba8Image& image, const Footprint& footprint) {
    constexpr int count = 256;
    std::array<double, 3> sum{};
    double weights = 0;
    const auto& c = footprint.corners;
    for (int j = 0; j < count; ++j) {
        for (int i = 0; i < count; ++i) {
            const double u = (i + 0.5) / count, v = (j + 0.5) / count;
            const auto mix = [&](double a, double b, double d, double e) {
                return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * e + u * d);
            };
            const double x = mix(c[0].x, c[1].x, c[2].x, c[3].x), y = mix(c[0].y, c[1].y, c[2].y, c[3].y);
            const double ux = (1 - v) * (c[1].x - c[0].x) + v * (c[2].x - c[3].x),
                         uy = (1 - v) * (c[1].y - c[0].y) + v * (c[2].y - c[3].y),
                         vx = (1 - u) * (c[3].x - c[0].x) + u * (c[2].x - c[1].x),
                         vy = (1 - u) * (c[3].y - c[0].y) + u * (c[2].y - c[1].y);
            const double weight = std::abs(ux * vy - uy * vx);
            const auto wrap = [](double at, std::int64_t origin) {
                return static_cast<std::int32_t>((origin + static_cast<std::int64_t>(std::floor(at))) &
                                                 (side - 1));
            };
            const std::uint8_t* texel = image.row(wrap(y, footprint.y)) + 4 * wrap(x, footprint.x);
            weights += weight;
            for (std::size_t k = 0; k < 3; ++k)
                sum[k] += weight * static_cast<double>(srgb_to_steps[texel[k]]) / 65535;
        }
    }
    for (double& channel : sum) channel /= weights;
    return sum;
}

TEST(AreaTruth, IsWhatManySamplesComeTo) {
    const Rgba8Image image = noise();
    const AreaTruth truth{image};
    std::mt19937_64 random{5};
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution{low, high}(random);
    };
    double worst = 0;
    for (int i = 0; i < 60; ++i) {
        const double size = std::exp2(uniform(-1, 5)), stretch = std::exp2(uniform(0, 4));
        const double angle = uniform(0, 6.28), c = std::cos(angle), s = std::sin(angle);
        Footprint footprint{(std::int64_t{1} << 38) - 100 + i, -12345 - i, {}, 0};
        const double along[] = {-1, 1, 0.8, -0.9}, across[] = {-1, -0.9, 1, 1.1};
        for (std::size_t k = 0; k < 4; ++k)
            footprint.corners[k] = {size * (stretch * along[k] * c - across[k] * s) / 2 + 0.3,
                                    size * (stretch * along[k] * s + across[k] * c) / 2 - 0.7};
        const auto exact = truth.mean(footprint), estimate = sampled(image, footprint);
        for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, std::abs(exact[k] - estimate[k]));
    }
    EXPECT_LT(worst, 0.004) << "256 × 256 samples on squares are good to about a line of them";
    EXPECT_GT(worst, 0) << "it is another method";
}

TEST(AreaTruth, OfWholeTexelsIsTheirMeanAndOfFarFootprintsTheImages) {
    const Rgba8Image image = noise();
    const AreaTruth truth{image};
    const Footprint one{7, 9, {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}, 0};
    EXPECT_NEAR(truth.mean(one)[1], static_cast<double>(srgb_to_steps[image.row(9)[4 * 7 + 1]]) / 65535,
                1e-12);
    const Footprint around{7, 9, {{{0, 0}, {0, 1}, {1, 1}, {1, 0}}}, 0};
    EXPECT_EQ(truth.mean(around), truth.mean(one)) << "either way around";

    double mean = 0;
    for (std::size_t at = 0; at < image.bytes.size(); at += 4)
        mean += static_cast<double>(srgb_to_steps[image.bytes[at]]) / 65535;
    mean /= side * side;
    const Footprint far{-3, 5, {{{0, 0}, {64000, 0}, {64000, 64}, {0, 64}}}, 0};
    EXPECT_NEAR(truth.mean(far)[0], mean, 1e-9);
    const Footprint oblique{0, 0, {{{0, 0}, {40000, 40000}, {40040, 39990}, {40, -10}}}, 0};
    EXPECT_NEAR(truth.mean(oblique)[0], mean, 0.01);
}

TEST(AreaTruth, OfASituationLeavesTheSkyUnmeasured) {
    const Situation situation = situations(80, 70)[1];
    const TruePicture picture = true_picture(situation, AreaTruth{noise()});
    EXPECT_EQ(picture.measured[0], 0);
    EXPECT_EQ(picture.measured.back(), 1);
    for (std::size_t at = 0; at < picture.measured.size(); ++at) {
        if (!picture.measured[at]) continue;
        EXPECT_GE(picture.linear[3 * at], 0.0F);
        EXPECT_LE(picture.linear[3 * at], 1.0F);
    }
}

}  // namespace
}  // namespace tessera
