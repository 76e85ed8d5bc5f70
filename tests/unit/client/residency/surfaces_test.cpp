// Hills and corridors as flat pieces.
#include <cmath>

#include <gtest/gtest.h>

#include "client/residency/height_field.h"
#include "client/residency/plane_view.h"

namespace tessera {
namespace {

const Surface hills{.kind = Surface::Kind::terrain};

Camera over(std::int64_t x, std::int64_t y, double pitch = -25) {
    return {.ground = {x, y, 0.25, 0.5}, .height_texels = 600, .yaw_degrees = 20, .pitch_degrees = pitch};
}

TEST(Surfaces, HillsAreTheSameNumbersEverywhereAndAlways) {
    EXPECT_EQ(made_height(0, 0, 256), made_height(0, 0, 256));
    EXPECT_EQ(made_height(123'456, -98'304, 256), 2'994'426);
    EXPECT_EQ(made_height(std::int64_t{1} << 37, std::int64_t{1} << 36, 256), 2'998'245);
    // The finest hills are left out where a mesh could not show them
    EXPECT_NE(made_height(5'000, 7'000, 256), made_height(5'000, 7'000, 4096));
}

TEST(Surfaces, AHillIsSeenBeforeWhatIsBehindItAndTheEyeIsAlwaysAboveIt) {
    int crossed = 0;
    for (int i = 0; i < 20; ++i) {
        const PlaneView view{over(70'000'000'000 + 9'137 * i, 1'234'567 + 7'919 * i, -8), 200, 160, hills};
        EXPECT_DOUBLE_EQ(view.eye_height(), 600 + base_height(hills, view.camera().ground));
        double last = 0;
        bool jumps = false;
        for (int y = 159; y >= 0; --y) {
            const auto ground = view.ground_at(100.5, y + 0.5);
            if (!ground) break;
            const double away = std::hypot(ground->x, ground->y);
            EXPECT_GT(away, 0.95 * last)
                << "row " << y;  // up the picture is never nearer, on hills as gentle as these
            jumps = jumps || away > 3 * last + 1000;
            last = away;
        }
        crossed += jumps ? 1 : 0;
    }
    EXPECT_GT(crossed, 2) << "some hills hide what is behind them";
}

TEST(Surfaces, AnImageOfHeightsRepeatsMirrored) {
    const HeightImage image{3, 2, {0, 100, 200, 300, 400, 500}};
    EXPECT_EQ(image.at(0, 0), 0);
    EXPECT_EQ(image.at(128, 0), 50);
    EXPECT_EQ(image.at(512, 256), 500);
    EXPECT_EQ(image.at(3 * 256, 0), 100);
    EXPECT_EQ(image.at(-256, 0), 100);
    EXPECT_EQ(image.at(0, 2 * 256), 0);
    EXPECT_EQ(image.at(std::int64_t{1024} * 1'000'000'000, 0), 0);
}

TEST(Surfaces, ACorridorFoldsItsTextureOverItsEdges) {
    const Camera camera = over(5'000'000, 6'000'000, 0);
    const Surface corridor = around({.kind = Surface::Kind::corridor}, camera);
    const PlaneView view{camera, 801, 701, corridor};
    // Straight ahead along the corridor's wall: neighbours in the picture are neighbours in the texture
    for (int y = 0; y < 700; ++y) {
        for (const int x : {300, 650}) {
            const auto here = view.ground_at(x + 0.5, y + 0.5), below = view.ground_at(x + 0.5, y + 1.5);
            if (!here || !below) continue;
            const double side =
                std::exp2(std::max(view.level_at(x + 0.5, y + 0.5), view.level_at(x + 0.5, y + 1.5)));
            EXPECT_LT(std::hypot(here->x - below->x, here->y - below->y), 2.1 * side) << x << ',' << y;
            EXPECT_LE(std::abs(here->x), 1.01 * corridor.half_side);
        }
    }
}

TEST(Surfaces, AWallUnderTheEyeIsThePlane) {
    const Camera camera = over(5'000'000, 6'000'000, -70);
    const PlaneView plane{camera, 200, 160},
        corridor{camera, 200, 160, around({.kind = Surface::Kind::corridor}, camera)};
    EXPECT_NEAR(plane.ground_at(100, 80)->x, corridor.ground_at(100, 80)->x, 1e-6);
    EXPECT_NEAR(plane.level_at(100, 80), corridor.level_at(100, 80), 1e-9);
}

}  // namespace
}  // namespace tessera
