#include "server/scenes/paint_pebbles.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include <gtest/gtest.h>
#include <xxhash.h>

namespace tessera {
namespace {

constexpr std::int32_t side = 128;

const Rgb8Image& painting() {
    static const Rgb8Image image = paint_pebbles(side, 1);
    return image;
}

int luma(const Rgb8Image& image, std::int32_t x, std::int32_t y) {
    const std::uint8_t* texel = image.bytes.data() + std::size_t(y * image.width + x) * 3;
    return (2 * texel[0] + 5 * texel[1] + texel[2]) / 8;
}

// Equal on every compiler and in every build type. Whoever changes the painting on purpose looks at it first,
// then takes the new number from the failure.
TEST(PaintPebbles, GivesTheSameBytesOnEveryMachine) {
    EXPECT_EQ(XXH3_64bits(painting().bytes.data(), painting().bytes.size()), 7247466472578105773u);
}

TEST(PaintPebbles, GivesTheSameSurfaceBelowThePictureOnEveryMachine) {
    const PaintedSurface surface = paint_pebble_surface(side, 1);
    const auto hash_of = [](const Rgb8Image& image) {
        return XXH3_64bits(image.bytes.data(), image.bytes.size());
    };
    EXPECT_EQ(surface.color.bytes, painting().bytes);
    EXPECT_EQ(hash_of(surface.normal), 14391919562758474605u);
    EXPECT_EQ(hash_of(surface.roughness), 6575703970012123877u);
    EXPECT_EQ(hash_of(surface.height), 4819540648249659172u);
}

TEST(PaintPebbles, NormalsAreUnitVectorsThatFollowTheHeights) {
    const PaintedSurface surface = paint_pebble_surface(side, 1);
    const auto at = [](const Rgb8Image& image, std::int32_t x, std::int32_t y, std::size_t c) {
        return int{image.bytes[std::size_t(y * image.width + x) * 3 + c]};
    };
    double x_agrees = 0, y_agrees = 0;
    for (std::int32_t y = 1; y + 1 < side; ++y)
        for (std::int32_t x = 1; x + 1 < side; ++x) {
            double n[3];
            for (std::size_t c = 0; c < 3; ++c) n[c] = at(surface.normal, x, y, c) / 127.5 - 1.0;
            ASSERT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0, 0.02);
            ASSERT_GT(n[2], 0);
            // Where it rises to the right, the normal leans left; where it rises downwards, it leans up
            x_agrees -= n[0] * (at(surface.height, x + 1, y, 0) - at(surface.height, x - 1, y, 0));
            y_agrees += n[1] * (at(surface.height, x, y + 1, 0) - at(surface.height, x, y - 1, 0));
        }
    EXPECT_GT(x_agrees, side * side);
    EXPECT_GT(y_agrees, side * side);
}

TEST(PaintPebbles, AnotherSeedPaintsOtherStones) {
    const Rgb8Image other = paint_pebbles(side, 2);
    std::size_t equal = 0;
    for (std::size_t i = 0; i < other.bytes.size(); ++i) equal += other.bytes[i] == painting().bytes[i];
    EXPECT_LT(equal, other.bytes.size() / 10);
}

TEST(PaintPebbles, HasDeepShadowsBrightStonesAndNoBurntOutWhite) {
    std::array<std::size_t, 256> histogram{};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) ++histogram[std::size_t(luma(painting(), x, y))];
    const auto share = [&](std::size_t from, std::size_t to) {
        std::size_t count = 0;
        for (std::size_t code = from; code < to; ++code) count += histogram[code];
        return static_cast<double>(count) / (side * side);
    };
    EXPECT_GT(share(0, 50), 0.02);
    EXPECT_GT(share(150, 256), 0.03);
    EXPECT_LT(share(0, 50), 0.5);
    EXPECT_LT(share(252, 256), 0.001);
}

TEST(PaintPebbles, BordersMeetAsSmoothlyAsNeighboursInside) {
    int across = 0, inside = 0;
    for (std::int32_t i = 0; i < side; ++i) {
        across += std::abs(luma(painting(), side - 1, i) - luma(painting(), 0, i)) +
                  std::abs(luma(painting(), i, side - 1) - luma(painting(), i, 0));
        inside += std::abs(luma(painting(), side / 2, i) - luma(painting(), side / 2 + 1, i)) +
                  std::abs(luma(painting(), i, side / 2) - luma(painting(), i, side / 2 + 1));
    }
    EXPECT_LT(across, 2 * inside);
}

TEST(PaintPebbles, ClampsASideOutsideItsRange) {
    const Rgb8Image image = paint_pebbles(-5, 1);
    EXPECT_EQ(image.width, min_painting_side);
    EXPECT_EQ(image.bytes.size(), std::size_t(min_painting_side) * min_painting_side * 3);
}

}  // namespace
}  // namespace tessera
