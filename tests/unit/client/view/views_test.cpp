// Surfaces, sides of a split picture, and heights from a file, as the viewer uses them.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <png.h>
#include <unistd.h>

#include "client/render/gl_context.h"
#include "client/view/camera_control.h"
#include "client/view/frame_painter.h"
#include "client/view/height_image_file.h"
#include "client/view/viewer_state.h"
#include "tests/unit/client/render/painted_pages.h"
#include "tests/unit/client/residency/fake_page_source.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::FakePageSource;
using ::testing::HasSubstr;

constexpr Extent extent{18};

ViewFrame frame_of(Filter filter) {
    return {.camera = {.ground = {5'000'000, 6'000'000, 0.5, 0.5},
                       .height_texels = 500,
                       .yaw_degrees = 30,
                       .pitch_degrees = -20},
            .width = 160,
            .height = 120,
            .filter = {filter}};
}

class Pictures : public ::testing::Test {
  protected:
    void SetUp() override {
        auto made = make_headless_context();
        ASSERT_TRUE(made) << made.error().detail;
        context_ = std::move(made.value());
        scene_ = make_scene(source_);
        second_ = make_scene(other_source_);
    }
    static std::unique_ptr<PlaneScene> make_scene(PageSource& source) {
        auto scene = PlaneScene::make(extent, source, {.slots = 256, .uploads_per_frame = 256});
        if (!scene) throw std::runtime_error{scene.error().detail};
        return std::move(*scene);
    }
    Rgba8Image picture(ViewFrame frame) {
        FramePainter painter{*scene_, second_.get()};
        frame.most_uploads = 256;
        for (int i = 0;; ++i) {
            frame.time = now_ += ClientTime{16};
            if (painter.update(frame).is_sharp()) break;
            if (i > 500) throw std::runtime_error{"never sharp"};
        }
        const FrameTarget target{frame.width, frame.height};
        if (const auto drawn = painter.draw(frame, target); !drawn)
            throw std::runtime_error{drawn.error().detail};
        return target.read();
    }
    static int others(const Rgba8Image& a, const Rgba8Image& b, int first, int end) {
        int count = 0;
        for (int y = 0; y < a.height; ++y)
            for (int x = first; x < end; ++x)
                count += std::equal(a.row(y) + 4 * x, a.row(y) + 4 * x + 4, b.row(y) + 4 * x) ? 0 : 1;
        return count;
    }

  private:
    std::unique_ptr<GlContext> context_;
    FakePageSource source_{[](PageKey page) { return testing::paint_page(page, testing::noise_texel); }};
    FakePageSource other_source_{[](PageKey page) {
        return testing::paint_page(page, [](int level, std::int64_t x, std::int64_t y) {
            auto texel = testing::noise_texel(level, x, y);
            std::swap(texel[0], texel[2]);
            return texel;
        });
    }};
    std::unique_ptr<PlaneScene> scene_, second_;
    ClientTime now_{};
};

TEST_F(Pictures, SplitInTwoFiltersShowEachOnItsSide) {
    for (const auto kind : {Surface::Kind::plane, Surface::Kind::terrain, Surface::Kind::corridor}) {
        ViewFrame left = frame_of(Filter::nearest), right = frame_of(Filter::line_integral);
        left.surface = right.surface = around({.kind = kind}, left.camera);
        ViewFrame split = left;
        split.split = SplitChoice{.at = 0.4, .filter = right.filter};
        const Rgba8Image both = picture(split), all_left = picture(left), all_right = picture(right);
        EXPECT_EQ(others(both, all_left, 0, 62), 0) << name_of(kind);
        EXPECT_EQ(others(both, all_right, 66, 160), 0) << name_of(kind);
        EXPECT_GT(others(all_left, all_right, 0, 160), 5000) << name_of(kind);
    }
}

TEST_F(Pictures, SplitInTwoSourcesShowTheOtherOnesPagesOnTheRight) {
    ViewFrame split = frame_of(Filter::trilinear);
    const Rgba8Image plain = picture(split);
    split.split = SplitChoice{.at = 0.5, .filter = split.filter, .is_second = true};
    const Rgba8Image both = picture(split);
    EXPECT_EQ(others(both, plain, 0, 78), 0);
    EXPECT_GT(others(both, plain, 82, 160), 5000);
}

TEST(Views, FollowOneAnotherAroundTheCamera) {
    const Camera camera = frame_of(Filter::nearest).camera;
    Surface surface;
    surface = surface_after(surface, 1, camera);
    EXPECT_EQ(surface.kind, Surface::Kind::terrain);
    surface = surface_after(surface, 1, camera);
    EXPECT_EQ(surface.kind, Surface::Kind::corridor);
    EXPECT_EQ(surface.middle_x, camera.ground.x);
    EXPECT_EQ(surface.half_side, camera.height_texels);
    EXPECT_EQ(surface_after(surface, 1, camera).kind, Surface::Kind::plane);
    EXPECT_EQ(surface_after(surface, -1, camera).kind, Surface::Kind::terrain);
}

TEST(Views, KeepTheCameraBetweenACorridorsWalls) {
    CameraControl control{frame_of(Filter::nearest).camera, extent};
    const Surface corridor = around({.kind = Surface::Kind::corridor}, control.camera());
    control.set_surface(corridor);
    for (int i = 0; i < 200; ++i)
        control.advance(0.1, {.forwards = 0.2, .sideways = 1, .upwards = 1, .fast = true});
    const Camera& camera = control.camera();
    EXPECT_LT(std::abs(static_cast<double>(camera.ground.x - corridor.middle_x)), corridor.half_side);
    EXPECT_LT(camera.height_texels, 2 * corridor.half_side);
    EXPECT_FALSE((PlaneView{camera, 80, 60, corridor}.pieces().empty()));
}

TEST(Views, SplitAndBecomeWholeAgain) {
    ViewerSwitches switches;
    switch_split(switches);
    ASSERT_TRUE(switches.split);
    EXPECT_NE(switches.split->filter.filter, switches.filter.filter);
    switch_split(switches);
    EXPECT_FALSE(switches.split);
}

class HeightFiles : public ::testing::Test {
  protected:
    void TearDown() override { fs::remove(file_); }
    void write(int width, int height, png_uint_32 format, const void* pixels) {
        png_image png{};
        png.version = PNG_IMAGE_VERSION;
        png.width = static_cast<png_uint_32>(width);
        png.height = static_cast<png_uint_32>(height);
        png.format = format;
        ASSERT_TRUE(png_image_write_to_file(&png, file_.c_str(), 0, pixels, 0, nullptr));
    }
    const fs::path file_ =
        fs::temp_directory_path() / ("tessera_heights_" + std::to_string(getpid()) + ".png");
};

TEST_F(HeightFiles, GiveTheirCodesAsTheyStand) {
    const std::uint8_t shallow[] = {0, 51, 102, 255};
    write(2, 2, PNG_FORMAT_GRAY, shallow);
    auto heights = read_height_image(file_);
    ASSERT_TRUE(heights) << heights.error().detail;
    EXPECT_EQ((*heights)->at(256, 0), 51 * 257);
    const std::uint16_t deep[] = {0, 1000, 30'000, 65'535};
    write(2, 2, PNG_FORMAT_LINEAR_Y, deep);
    heights = read_height_image(file_);
    ASSERT_TRUE(heights) << heights.error().detail;
    EXPECT_EQ((*heights)->at(256, 0), 1000);
    EXPECT_EQ((*heights)->at(0, 256), 30'000);
}

TEST_F(HeightFiles, AreRefusedWithAReason) {
    EXPECT_THAT(read_height_image("/nowhere.png").error().detail, HasSubstr("/nowhere.png"));
    std::ofstream{file_} << "no picture";
    EXPECT_THAT(read_height_image(file_).error().detail, HasSubstr("no PNG"));
    const std::uint8_t one[] = {7};
    write(1, 1, PNG_FORMAT_GRAY, one);
    EXPECT_THAT(read_height_image(file_).error().detail, HasSubstr("2 to 8192"));
}

}  // namespace
}  // namespace tessera
