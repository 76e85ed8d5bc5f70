#include "client/residency/camera_motion.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

using namespace std::chrono_literals;

Camera start() {
    return {.ground = {std::int64_t{1} << 37, 5'000'000, 0.5, 0.5}, .height_texels = 500, .yaw_degrees = 350};
}

TEST(CameraMotion, SaysWhereATurnAndAFlightWillBe) {
    CameraMotion motion;
    Camera camera = start();
    for (ClientTime now = 0ms; now <= 1000ms; now += 16ms) {
        motion.observe(camera, now);
        camera.yaw_degrees += 0.09 * 16;
        if (camera.yaw_degrees >= 360) camera.yaw_degrees -= 360;
        camera.ground = camera.ground.moved(3.25 * 16, -16);
    }
    const auto soon = motion.in(100ms, Extent{30});
    ASSERT_TRUE(soon);
    // `camera` is 16 ms ahead of what was observed
    EXPECT_NEAR(std::remainder(soon->yaw_degrees - camera.yaw_degrees, 360), 0.09 * 84, 0.1);
    EXPECT_NEAR(distance_x(camera.ground, soon->ground), 3.25 * 84, 1);
    EXPECT_NEAR(distance_y(camera.ground, soon->ground), -84, 1);
}

TEST(CameraMotion, SaysNothingAtRestAndAfterALeap) {
    CameraMotion motion;
    Camera camera = start();
    EXPECT_FALSE(motion.in(100ms, Extent{30}));
    for (ClientTime now = 0ms; now <= 300ms; now += 16ms) motion.observe(camera, now);
    EXPECT_FALSE(motion.in(100ms, Extent{30}));
    camera.ground.x -= 1'000'000;
    motion.observe(camera, 316ms);
    EXPECT_FALSE(motion.in(100ms, Extent{30}));
}

TEST(CameraMotion, StaysInsideTheExtent) {
    CameraMotion motion;
    Camera camera = start();
    camera.ground = {100, 100, 0, 0};
    for (ClientTime now = 0ms; now <= 80ms; now += 16ms) {
        motion.observe(camera, now);
        camera.ground = camera.ground.moved(-15, -15);
    }
    const auto soon = motion.in(2000ms, Extent{0});
    ASSERT_TRUE(soon);
    EXPECT_EQ(soon->ground.x, 0);
    EXPECT_EQ(soon->ground.y, 0);
}

}  // namespace
}  // namespace tessera
