#include "client/view/camera_path.h"

#include <gmock/gmock.h>

namespace tessera {
namespace {

using ::testing::HasSubstr;

constexpr Extent widest{30};

TEST(CameraPath, KeepsEveryTexelOfAPositionBeyond2ToThe53) {
    const auto path = CameraPath::parse(
        R"({"keys": [{"x": "274877906943", "y": 7, "x_fraction": 0.25, "height": 10, "pitch": -90}]})",
        "path", widest);
    ASSERT_TRUE(path) << path.error().detail;
    EXPECT_EQ(path->at(0).ground, (PlanePoint{274877906943, 7, 0.25, 0}));
    EXPECT_EQ(path->at(99).ground, path->at(0).ground);
}

TEST(CameraPath, MovesEvenlyBetweenItsKeysAndClimbsByEqualFactors) {
    const auto path = CameraPath::parse(R"({"field_of_view": 40, "keys": [
        {"time": 1, "x": "137438953472", "y": 100, "height": 100, "yaw": 0, "pitch": -90},
        {"time": 3, "x": "137438953572", "y": 0, "height": 10000, "yaw": 90, "pitch": -30}]})",
                                        "path", widest);
    ASSERT_TRUE(path) << path.error().detail;
    EXPECT_EQ(path->at(0), path->at(1));
    const Camera middle = path->at(2);
    EXPECT_EQ(middle.ground, (PlanePoint{137438953522, 50, 0, 0}));
    EXPECT_NEAR(middle.height_texels, 1000, 1e-6);
    EXPECT_NEAR(middle.yaw_degrees, 45, 1e-9);
    EXPECT_NEAR(middle.pitch_degrees, -60, 1e-9);
    EXPECT_EQ(middle.field_of_view_degrees, 40);
    EXPECT_EQ(path->end_seconds(), 3);
}

TEST(CameraPath, ReadsTheKeyThatTheViewerPrints) {
    const Camera camera{.ground = {1'234'567'890'123, 42, 0.5, 0.75},
                        .height_texels = 321.5,
                        .yaw_degrees = -12,
                        .pitch_degrees = -7};
    const auto path =
        CameraPath::parse("{\"keys\": [" + camera_key_json(0, camera) + "]}", "path", Extent{30});
    EXPECT_FALSE(path) << "outside the extent";
    Camera inside = camera;
    inside.ground.x = 123'456'789'012;
    const auto good =
        CameraPath::parse("{\"keys\": [" + camera_key_json(0, inside) + "]}", "path", Extent{30});
    ASSERT_TRUE(good) << good.error().detail;
    EXPECT_EQ(good->at(0), inside);
}

TEST(CameraPath, SaysWhichKeyAndFieldIsWrong) {
    const auto problem = [](const char* json) {
        const auto path = CameraPath::parse(json, "walk.json", Extent{10});
        return path ? std::string{"no error"} : path.error().detail;
    };
    EXPECT_THAT(problem("{"), HasSubstr("walk.json"));
    EXPECT_THAT(problem("{}"), HasSubstr("at least one key"));
    EXPECT_THAT(problem(R"({"keys": [{"hight": 3}]})"), HasSubstr("hight"));
    EXPECT_THAT(problem(R"({"keys": [{"x": 1}]})"), HasSubstr("keys[0]: height"));
    EXPECT_THAT(problem(R"({"keys": [{"x": 262144, "height": 1}]})"),
                HasSubstr("keys[0]: x and y must be 0 to 262143"));
    EXPECT_THAT(problem(R"({"keys": [{"x": -1, "height": 1}]})"), HasSubstr("keys[0]: x and y"));
    EXPECT_THAT(problem(R"({"keys": [{"height": 1, "pitch": 90}]})"), HasSubstr("keys[0]: pitch"));
    EXPECT_THAT(problem(R"({"keys": [{"height": 1}, {"height": 1}]})"), HasSubstr("keys[1]: time"));
    EXPECT_THAT(problem(R"({"keys": [{"height": 1, "x_fraction": 1}]})"), HasSubstr("x_fraction"));
    EXPECT_THAT(problem(R"({"keys": [{"height": 1}], "field_of_view": 170})"), HasSubstr("field_of_view"));
    const auto missing = CameraPath::read("/nowhere/walk.json", Extent{10});
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().detail, HasSubstr("/nowhere/walk.json"));
}

TEST(FirstCamera, StandsInsideTheSmallestAndTheWidestExtent) {
    for (const Extent extent : {Extent{0}, Extent{5}, Extent{30}}) {
        const Camera camera = first_camera(extent);
        EXPECT_GT(camera.ground.x, 0);
        EXPECT_LT(camera.ground.x, extent.side_texels());
        EXPECT_GT(camera.height_texels, 0);
    }
}

TEST(FirstCamera, LooksAtTheOpeningViewsMiddleWithItsTexelsUnderAPixel) {
    const Extent extent{10};
    for (const OpeningView view : {OpeningView{131072, 100000, 2}, OpeningView{3, 4, -6},
                                   OpeningView{9, extent.side_texels() - 1, 0}, OpeningView{0, 0, 10}}) {
        const Camera camera = first_camera(view, extent, 700);
        const double radians = std::numbers::pi / 180, down = -camera.pitch_degrees * radians;
        const double distance = camera.height_texels / std::sin(down);
        EXPECT_NEAR(2 * distance * std::tan(camera.field_of_view_degrees / 2 * radians) / 700,
                    std::exp2(view.level), 1e-9 * std::exp2(view.level));
        EXPECT_EQ(camera.yaw_degrees, 0);
        const PlanePoint seen = camera.ground.moved(0, -distance * std::cos(down));
        EXPECT_EQ(seen.x, view.x);
        EXPECT_EQ(seen.y, view.y);
        EXPECT_LT(camera.ground.y, extent.side_texels());
    }
}

}  // namespace
}  // namespace tessera
