#include "server/scenes/moving_scenes.h"

#include <gtest/gtest.h>

#include "server/scenes/patterns/lettering.h"
#include "server/scenes/patterns/lights.h"
#include "server/scenes/sample_scenes.h"

namespace tessera {
namespace {

using namespace painting;

TEST(MovingScenes, AreSamples) {
    for (const std::string_view name : moving_scene_names()) {
        ASSERT_NE(find_sample(name), nullptr) << name;
        EXPECT_EQ(find_sample(name)->source, Sample::Source::moving);
    }
}

TEST(MovingScenes, SayHowFastTheyPlay) {
    for (const std::string_view name : moving_scene_names()) {
        const PaintedScene painted = paint_moving_scene(name);
        EXPECT_GT(painted.scene.clock().steps_per_second(), 0) << name;
        EXPECT_FALSE(painted.files.empty()) << name;
    }
}

TEST(Leds, ShineMoreTheMoreTheyAreLit) {
    double last = -1;
    for (const double lit : {0.0, 0.3, 0.65, 1.0}) {
        const Rgba8Image led = paint_led(lit, 16);
        double red = 0;
        for (std::size_t i = 0; i < led.bytes.size(); i += 4) {
            red += led.bytes[i];
            ASSERT_EQ(led.bytes[i + 3], 255);
        }
        EXPECT_GT(red, last);
        last = red;
    }
}

TEST(Lettering, HasRimsAroundItsStrokes) {
    Board board{200, 100, std::vector<std::uint8_t>(200 * 100)};
    write_text(board, "L T", 10, 1, 2);
    int inside = 0, rim = 0;
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 200; ++x) {
            const int code = board.codes[static_cast<std::size_t>(y * 200 + x)];
            inside += code == 1;
            rim += code == 2;
            if (code != 1) continue;
            for (const int beside : {-1, 1, -200, 200})
                ASSERT_NE(board.codes[static_cast<std::size_t>(y * 200 + x + beside)], 0) << x << ", " << y;
        }
    EXPECT_GT(inside, 4 * rim / 3);
    EXPECT_GT(rim, 100);
}

}  // namespace
}  // namespace tessera
