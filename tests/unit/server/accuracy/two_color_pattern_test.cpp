#include "server/accuracy/two_color_pattern.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "server/accuracy/measured_texture.h"
#include "shared/math/hash.h"

namespace tessera {
namespace {

double unit(std::uint64_t index) { return double(mix(index) >> 11) * 0x1p-53; }

/// A checker's share by brute force: squares clipped by the footprint, one after the other.
double clipped_share(const Footprint& footprint, std::int32_t side) {
    double inked = 0;
    double least_x = 1e300, most_x = -1e300, least_y = 1e300, most_y = -1e300;
    for (const TexelPoint& c : footprint.corners) {
        least_x = std::min(least_x, c.x);
        most_x = std::max(most_x, c.x);
        least_y = std::min(least_y, c.y);
        most_y = std::max(most_y, c.y);
    }
    const auto square = [&](double origin, double at) {
        return static_cast<std::int64_t>(std::floor((origin + at) / side));
    };
    const double ox = double(footprint.x), oy = double(footprint.y);
    for (std::int64_t j = square(oy, least_y); j <= square(oy, most_y); ++j)
        for (std::int64_t i = square(ox, least_x); i <= square(ox, most_x); ++i) {
            if ((i + j) % 2 == 0) continue;
            std::vector<TexelPoint> polygon(footprint.corners.begin(), footprint.corners.end());
            const auto cut = [&](double nx, double ny, double at) {
                std::vector<TexelPoint> kept;
                for (std::size_t k = 0; k < polygon.size(); ++k) {
                    const TexelPoint a = polygon[k], b = polygon[(k + 1) % polygon.size()];
                    const double da = nx * a.x + ny * a.y - at, db = nx * b.x + ny * b.y - at;
                    if (da <= 0) kept.push_back(a);
                    if ((da < 0 && db > 0) || (da > 0 && db < 0))
                        kept.push_back(
                            {a.x + (b.x - a.x) * da / (da - db), a.y + (b.y - a.y) * da / (da - db)});
                }
                polygon = std::move(kept);
            };
            const double x = double(i * side) - ox, y = double(j * side) - oy;
            cut(-1, 0, -x);
            cut(1, 0, x + side);
            cut(0, -1, -y);
            cut(0, 1, y + side);
            for (std::size_t k = 0; k < polygon.size(); ++k) {
                const TexelPoint a = polygon[k], b = polygon[(k + 1) % polygon.size()];
                inked += (a.x * b.y - a.y * b.x) / 2;
            }
        }
    return std::fabs(inked) / area_of(footprint);
}

TEST(InkIntegral, OfACheckerIsTheSumOfItsClippedSquares) {
    const MeasuredTexture checker = checker_texture();
    const InkIntegral ink{*checker.pattern};
    for (std::uint64_t i = 0; i < 60; ++i) {
        const double size = std::exp2(2 + 8 * unit(16 * i + 1)), angle = 6.28 * unit(16 * i + 2),
                     thin = 0.02 + unit(16 * i + 3);
        const Footprint footprint = footprint_around(
            static_cast<std::int64_t>(unit(16 * i + 4) * 2000) - 1000,
            static_cast<std::int64_t>(unit(16 * i + 5) * 2000) - 1000, {unit(16 * i + 6), unit(16 * i + 7)},
            {size * std::cos(angle), size * std::sin(angle)},
            {-size * thin * std::sin(angle), size * thin * std::cos(angle)});
        EXPECT_NEAR(ink.share(footprint), clipped_share(footprint, 32), 1e-9) << i;
    }
}

TEST(InkIntegral, DoesNotDependOnHowFarOutOrWhichWayRound) {
    const MeasuredTexture text = text_texture();
    const InkIntegral ink{*text.pattern};
    Footprint here{-17, 9, {{{0.25, 0.5}, {90.5, 13.75}, {101.25, 60.5}, {3.5, 41.25}}}, 0};
    const double share = ink.share(here);
    EXPECT_GT(share, 0.02);
    EXPECT_LT(share, 0.6);
    Footprint far = here;
    far.x += (std::int64_t{1} << 38);
    far.y -= (std::int64_t{1} << 38);
    EXPECT_EQ(ink.share(far), share);
    std::swap(here.corners[1], here.corners[3]);
    EXPECT_NEAR(ink.share(here), share, 1e-12);
}

TEST(InkIntegral, OfWholeTexelsIsTheirMean) {
    const MeasuredTexture text = text_texture();
    const InkIntegral ink{*text.pattern};
    const TwoColorPattern& pattern = *text.pattern;
    const auto total = std::ranges::count(pattern.inked, 1);
    EXPECT_NEAR(ink.share({0, 0, {{{0, 0}, {1024, 0}, {1024, 1024}, {0, 1024}}}, 0}),
                double(total) / double(pattern.inked.size()), 1e-12);
    for (std::int64_t y = 0; y < 40; ++y)
        for (std::int64_t x = 0; x < 40; ++x)
            EXPECT_NEAR(ink.share({x * 2, y * 2, {{{0, 0}, {2, 0}, {2, 2}, {0, 2}}}, 0}),
                        pattern.inked[std::size_t(y) * std::size_t(pattern.width) + std::size_t(x)], 1e-12);
}

TEST(InkIntegral, OfAFootprintWithoutAreaIsTheSquareUnderIt) {
    const InkIntegral ink{*checker_texture().pattern};
    EXPECT_EQ(ink.share({40, 5, {}, 0}), 1);
    EXPECT_EQ(ink.share({5, 5, {}, 0}), 0);
}

}  // namespace
}  // namespace tessera
