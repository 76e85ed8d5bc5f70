#include "client/residency/plane_view.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

TEST(PlaneView, LooksStraightDownWithNorthUpAndEastRight) {
    const PlaneView view{{.height_texels = 100, .yaw_degrees = 0, .pitch_degrees = -90}, 800, 700};
    const auto middle = view.ground_at(400, 350);
    ASSERT_TRUE(middle);
    EXPECT_NEAR(middle->x, 0, 1e-9);
    EXPECT_NEAR(middle->y, 0, 1e-9);
    EXPECT_GT(view.ground_at(500, 350)->x, 10);
    EXPECT_LT(view.ground_at(400, 200)->y, -10);
}

TEST(PlaneView, TurnsClockwiseWithTheYaw) {
    const PlaneView view{{.height_texels = 100, .yaw_degrees = 90, .pitch_degrees = -30}, 800, 700};
    const auto middle = view.ground_at(400, 350);
    ASSERT_TRUE(middle);
    EXPECT_NEAR(middle->x, 100 * std::sqrt(3.0), 1e-6);
    EXPECT_NEAR(middle->y, 0, 1e-6);
}

TEST(PlaneView, SeesNoGroundAboveTheHorizon) {
    const PlaneView view{{.pitch_degrees = 0}, 800, 700};
    EXPECT_FALSE(view.ground_at(400, 349));
    EXPECT_TRUE(view.ground_at(400, 351));
}

TEST(PlaneView, ItsLevelIsThatOfNumericalDerivatives) {
    for (const double pitch : {-89.0, -60.0, -35.0, -12.0, -3.0}) {
        const PlaneView view{{.height_texels = 700, .yaw_degrees = 33, .pitch_degrees = pitch}, 800, 700};
        for (double y = 399.5; y < 700; y += 50) {
            for (double x = 0.5; x < 800; x += 50) {
                constexpr double e = 1e-4;
                const auto left = view.ground_at(x - e, y), right = view.ground_at(x + e, y);
                const auto above = view.ground_at(x, y - e), below = view.ground_at(x, y + e);
                if (!above) continue;
                const double dx = std::hypot(right->x - left->x, right->y - left->y) / (2 * e);
                const double dy = std::hypot(below->x - above->x, below->y - above->y) / (2 * e);
                EXPECT_NEAR(view.level_at(x, y), std::log2(std::max(dx, dy)), 1e-4)
                    << pitch << ' ' << x << ' ' << y;
            }
        }
    }
}

TEST(PlanePoint, MovesAcrossWholeTexelsWithoutLosingItsFraction) {
    const std::int64_t far = std::int64_t{1} << 37;
    const PlanePoint p = PlanePoint{far, -far, 0.75, 0.25}.moved(0.5, -0.5);
    EXPECT_EQ(p, (PlanePoint{far + 1, -far - 1, 0.25, 0.75}));
    EXPECT_DOUBLE_EQ(distance_x({far, 0, 0.75, 0}, p), 0.5);
}

}  // namespace
}  // namespace tessera
