#include "client/view/path_recorder.h"

#include <gtest/gtest.h>

namespace tessera {
namespace {

constexpr Extent extent{20};

Camera at(std::int64_t x, double height = 500) {
    return {
        .ground = {x, 7'000'000, 0.25, 0}, .height_texels = height, .yaw_degrees = 10, .pitch_degrees = -30};
}

TEST(PathRecorder, WritesAPathThatLeadsWhereTheCameraWent) {
    PathRecorder recorder;
    recorder.start_recording();
    for (int frame = 0; frame < 200; ++frame)
        EXPECT_FALSE(recorder.advance(0.02, at(5'000'000 + 10 * frame)));
    const auto path = CameraPath::parse(recorder.stop_recording(), "recorded", extent);
    ASSERT_TRUE(path) << path.error().detail;
    EXPECT_NEAR(path->end_seconds() - path->begin_seconds(), 3.9, 0.15);
    const Camera middle = path->at(path->begin_seconds() + 2);
    EXPECT_NEAR(distance_x(at(5'000'000).ground, middle.ground), 1000, 15);
    EXPECT_FALSE(recorder.is_recording());
}

TEST(PathRecorder, KeepsARestAsTwoKeys) {
    PathRecorder recorder;
    recorder.start_recording();
    for (int frame = 0; frame < 1000; ++frame) recorder.advance(0.1, at(5'000'000));
    recorder.advance(0.1, at(5'000'100));
    const std::string text = recorder.stop_recording();
    EXPECT_EQ(std::count(text.begin(), text.end(), '{'), 4) << text;
    const auto path = CameraPath::parse(text, "recorded", extent);
    ASSERT_TRUE(path) << path.error().detail;
    EXPECT_EQ(path->at(99).ground.x, 5'000'000);
}

TEST(PathRecorder, PlaysAPathToItsEnd) {
    PathRecorder recorder;
    recorder.start_recording();
    for (int frame = 0; frame < 20; ++frame) recorder.advance(0.1, at(5'000'000 + 100 * frame));
    recorder.play(*CameraPath::parse(recorder.stop_recording(), "recorded", extent));
    int frames = 0;
    Camera last;
    for (; recorder.is_playing() && frames < 1000; ++frames) last = *recorder.advance(0.05, at(0));
    EXPECT_NEAR(frames, 38, 2);
    EXPECT_EQ(last.ground.x, 5'001'900);
    EXPECT_FALSE(recorder.advance(0.05, at(0)));
}

TEST(PathRecorder, HasNothingToWriteBeforeTheFirstFrame) {
    PathRecorder recorder;
    recorder.start_recording();
    EXPECT_EQ(recorder.stop_recording(), "");
}

}  // namespace
}  // namespace tessera
