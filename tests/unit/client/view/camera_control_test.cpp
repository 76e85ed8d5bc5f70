#include "client/view/camera_control.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

constexpr int width = 800, height = 600;

CameraControl control_at(std::int64_t place, double pitch = -40) {
    return {
        {.ground = {place, place, 0.5, 0.5}, .height_texels = 400, .yaw_degrees = 30, .pitch_degrees = pitch},
        Extent{30}};
}

PlanePoint under(const CameraControl& control, double x, double y) {
    const PlaneView view{control.camera(), width, height};
    const auto ground = view.ground_at(x, y);
    return control.camera().ground.moved(ground->x, ground->y);
}

TEST(CameraControl, DragsThePlaneWithTheCursorAlsoFarFromTheOrigin) {
    CameraControl control = control_at(std::int64_t{1} << 37);
    const PlanePoint held = under(control, 300, 400);
    control.drag_plane(width, height, 300, 400, 420, 330);
    const PlanePoint now = under(control, 420, 330);
    EXPECT_NEAR(distance_x(held, now), 0, 1e-6);
    EXPECT_NEAR(distance_y(held, now), 0, 1e-6);
}

TEST(CameraControl, ZoomsToThePointUnderTheCursorWhichStaysThere) {
    CameraControl control = control_at(1 << 25);
    const PlanePoint target = under(control, 500, 450);
    control.zoom_at(width, height, 500, 450, 4);
    for (int frame = 0; frame < 120; ++frame) control.advance(1 / 60.0, {});
    EXPECT_NEAR(control.camera().height_texels, 400 * std::exp2(-1.2), 1);
    EXPECT_NEAR(distance_x(target, under(control, 500, 450)), 0, 0.01);
    EXPECT_NEAR(distance_y(target, under(control, 500, 450)), 0, 0.01);
}

TEST(CameraControl, OrbitsAroundTheMiddleOfThePicture) {
    CameraControl control = control_at(1 << 25);
    const PlanePoint centre = under(control, width / 2.0, height / 2.0);
    control.orbit(70, -20);
    EXPECT_NEAR(control.camera().yaw_degrees, 100, 1e-9);
    EXPECT_NEAR(control.camera().pitch_degrees, -60, 1e-9);
    EXPECT_NEAR(distance_x(centre, under(control, width / 2.0, height / 2.0)), 0, 1e-3);
    EXPECT_NEAR(distance_y(centre, under(control, width / 2.0, height / 2.0)), 0, 1e-3);
}

TEST(CameraControl, FliesAlongItsHeadingAndComesToRest) {
    CameraControl control{{.ground = {1 << 25, 1 << 25, 0, 0}, .height_texels = 100, .yaw_degrees = 90},
                          Extent{30}};
    for (int frame = 0; frame < 60; ++frame) control.advance(1 / 60.0, {.forwards = 1});
    const PlanePoint there = control.camera().ground;
    EXPECT_GT(there.x, (1 << 25) + 50);
    EXPECT_NEAR(static_cast<double>(there.y), 1 << 25, 1);
    for (int frame = 0; frame < 300; ++frame) control.advance(1 / 60.0, {});
    const PlanePoint rest = control.camera().ground;
    control.advance(1 / 60.0, {});
    EXPECT_NEAR(distance_x(rest, control.camera().ground), 0, 1e-3);
}

TEST(CameraControl, StaysAboveTheExtentWhateverTheHandsDo) {
    const Extent extent{2};
    CameraControl control{{.ground = {500, 500, 0, 0}, .height_texels = 300}, extent};
    for (int i = 0; i < 3000; ++i) {
        control.advance(0.05, {.forwards = i % 500 < 250 ? 1.0 : -1.0,
                               .sideways = 1,
                               .upwards = i % 700 < 350 ? 1.0 : -1.0,
                               .fast = true});
        if (i % 3 == 0) control.orbit(13, i % 2 ? 7 : -9);
        if (i % 5 == 0) control.zoom_at(width, height, 400, 20, i % 2 ? 9 : -9);
        if (i % 7 == 0) control.drag_plane(width, height, 10, 10, 700, 590);
        const Camera& camera = control.camera();
        ASSERT_GE(camera.ground.x, 0);
        ASSERT_GE(camera.ground.y, 0);
        ASSERT_LT(camera.ground.x, extent.side_texels());
        ASSERT_LT(camera.ground.y, extent.side_texels());
        ASSERT_GE(camera.height_texels, 2);
        ASSERT_LE(camera.height_texels, 2.0 * static_cast<double>(extent.side_texels()));
        ASSERT_GE(camera.pitch_degrees, -90);
        ASSERT_LE(camera.pitch_degrees, 89);
    }
}

}  // namespace
}  // namespace tessera
