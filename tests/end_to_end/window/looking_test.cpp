// Flying and looking in a real window: camera, switches, screenshots, sizes and scales of screens.
#include <algorithm>
#include <cmath>
#include <fstream>

#include <X11/keysym.h>
#include <gmock/gmock.h>
#include <png.h>

#include "tests/end_to_end/window/window_program.h"

namespace tessera::test {
namespace {

class LookingWindow : public WindowOnMeadow {
  protected:
    static XScreen::Size size_of(const std::string& png_file) {
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        if (!png_image_begin_read_from_file(&image, png_file.c_str())) return {};
        const XScreen::Size size{static_cast<int>(image.width), static_cast<int>(image.height)};
        png_image_free(&image);
        return size;
    }
    bool says(const std::string& words) {
        return until([&] { return screen->title().find(words) != std::string::npos; });
    }
    std::string screenshot(const std::vector<xcb_keysym_t>& with = {}) {
        screen->tap('p', with);
        return viewer->line_after("wrote ");
    }
};

TEST_F(LookingWindow, FliesByMouseAndKeysAndComesHome) {
    ASSERT_NO_FATAL_FAILURE(open());
    const double high = camera("height");
    EXPECT_NEAR(high, looks.height_texels, 1e-3);
    screen->click(500, 320, 4);  // the wheel
    EXPECT_TRUE(until([&] { return camera("height") < 0.99 * high; }));
    screen->drag(500, 320, 700, 250, 3);
    EXPECT_TRUE(until([&] { return std::abs(camera("yaw")) > 1; })) << "turned the head";
    screen->tap(XK_Home);
    EXPECT_TRUE(until([&] { return std::abs(camera("height") - high) < 1e-3; }));
    screen->drag(500, 320, 540, 320);
    EXPECT_TRUE(until([&] { return std::abs(camera("x") - (middle - 10)) <= 1; })) << "40 pixels, 10 texels";
    const double y = camera("y");
    screen->hold('w');
    EXPECT_TRUE(until([&] { return camera("y") < y - 2; }));
    screen->let_go('w');
}

TEST_F(LookingWindow, EachKeySwitchesWhatTheHelpSays) {
    ASSERT_NO_FATAL_FAILURE(open());
    EXPECT_TRUE(says("plane - trilinear"));
    screen->tap('f', {XK_Shift_L});
    EXPECT_TRUE(says("bilinear"));
    screen->tap('6');
    EXPECT_TRUE(says("line integral"));
    screen->tap('7');
    EXPECT_TRUE(says("supersampling"));
    screen->tap('1');
    EXPECT_TRUE(says("nearest texel"));
    screen->tap('v');
    EXPECT_TRUE(says("terrain"));
    screen->tap('v');
    EXPECT_TRUE(says("corridor"));
    screen->tap('v');
    EXPECT_TRUE(says("plane"));
    for (const char key : {'b', 'b', 'b', 'm', 'o', 't', 'h'}) screen->tap(static_cast<xcb_keysym_t>(key));
    let_frames_pass();
    screen->tap(XK_Escape);  // the help
    let_frames_pass();
    screen->tap(XK_Escape);  // the window
    EXPECT_EQ(viewer->end().exit_code, 0);
}

TEST_F(LookingWindow, RecordsTheCamerasWayAndPlaysIt) {
    ASSERT_NO_FATAL_FAILURE(open());
    screen->tap('r');
    let_frames_pass();
    screen->drag(500, 320, 700, 320, 3);
    ASSERT_TRUE(until([&] { return std::abs(camera("yaw")) > 1; }));
    const double turned = camera("yaw");
    screen->tap('r');
    const std::string file = viewer->line_after("wrote ");
    EXPECT_TRUE(std::filesystem::exists(file)) << file;
    screen->tap(XK_Home);
    ASSERT_TRUE(until([&] { return std::abs(camera("yaw")) < 1e-6; }));
    screen->tap('l');
    EXPECT_TRUE(until([&] { return std::abs(camera("yaw") - turned) < 1e-3; })) << "and stays at its end";
}

TEST_F(LookingWindow, TheCacheIsResizedByItsSliderAndASessionOfItIsDrawnAgain) {
    const std::string figures = (files.path / "figures.json").string(),
                      session = (files.path / "session").string();
    ASSERT_NO_FATAL_FAILURE(
        open({"--filter", "line-integral", "--metrics", figures, "--record", session, "--record-hashes"}, 96,
             "800x760"));
    const auto cache_megabytes = [&] {  // of the last whole line
        std::ifstream file{figures};
        double bytes = 0;
        for (std::string line; std::getline(file, line);)
            if (const std::size_t at = line.find("\"cache_bytes\""); at != std::string::npos)
                bytes = std::atof(line.c_str() + line.find_first_of("0123456789", at));
        return bytes / 1e6;
    };
    ASSERT_TRUE(until([&] { return cache_megabytes() > 250; })) << cache_megabytes();
    constexpr std::uint32_t slider_colour = 0x29303b;
    const auto sliders = runs_of(slider_colour, 60);
    ASSERT_FALSE(sliders.empty());
    const double y = sliders.back().y - 5;
    screen->drag(sliders.back().x + 40, y, 30, y);
    EXPECT_TRUE(until([&] { return cache_megabytes() > 0 && cache_megabytes() < 200; })) << cache_megabytes();
    let_frames_pass();
    screen->tap(XK_Escape);
    ASSERT_EQ(viewer->end().exit_code, 0);
    testing::Program replay{
        {VIEW_PROGRAM, "--replay", session, "--headless", "-o", (files.path / "again").string()}};
    const auto ended = replay.end();
    EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.error;
}

TEST_F(LookingWindow, ASplitPicturesLineIsDragged) {
    ASSERT_NO_FATAL_FAILURE(open({"--filter", "nearest"}));
    screen->tap(XK_Tab);
    screen->tap('x');
    const auto line_at = [&] {  // the white line's column, below the labels
        const XScreen::Picture picture = screen->picture();
        for (int x = 0; x < picture.width; ++x) {
            bool is_line = true;
            for (int y = picture.height / 2 + 60; is_line && y < picture.height / 2 + 200; ++y)
                is_line = picture.at(x, y) == 0xf2f7ff;
            if (is_line) return x;
        }
        return -1;
    };
    EXPECT_TRUE(until([&] { return std::abs(line_at() - width / 2) <= 2; })) << line_at();
    screen->drag(width / 2, 500, 650, 480);
    EXPECT_TRUE(until([&] { return std::abs(line_at() - 650) <= 3; })) << line_at();
    EXPECT_NEAR(camera("x"), middle, 1e-9) << "the plane stays";
}

TEST_F(LookingWindow, FollowsTheWindowsSizeWhilePagesCome) {
    ASSERT_NO_FATAL_FAILURE(open());
    const XScreen::Size sizes[] = {{500, 400}, {1, 1}, {1270, 1000}, {64, 900}, {800, 640}};
    for (const XScreen::Size& size : sizes) {
        screen->tap('w');
        screen->resize(size.width, size.height);
        std::string file;
        ASSERT_TRUE(until([&] {
            file = screenshot();
            return size_of(file) == size;
        })) << file;
    }
    screen->hide();
    std::this_thread::sleep_for(std::chrono::milliseconds{300});
    screen->show();
    EXPECT_NE(screenshot({XK_Shift_L}), "") << "it goes on after having been out of sight";
}

TEST_F(LookingWindow, IsTwiceAsLargeOnAScreenOfTwiceTheDots) {
    ASSERT_NO_FATAL_FAILURE(open({}, 192, "500x400"));
    EXPECT_EQ(screen->window_size(), (XScreen::Size{1000, 800}));
    EXPECT_EQ(size_of(screenshot({XK_Shift_L})), (XScreen::Size{1000, 800}));
}

}  // namespace
}  // namespace tessera::test
