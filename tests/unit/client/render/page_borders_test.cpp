#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/unit/client/render/offscreen.h"
#include "tests/unit/client/render/painted_pages.h"

namespace tessera {
namespace {

using testing::Offscreen;

TEST(PageBorders, AreThinLinesOverAnOtherwiseUnchangedPicture) {
    const auto grey = [](PageKey) {
        std::string bytes(slot_bytes, '\x60');
        for (std::size_t at = 3; at < bytes.size(); at += 4) bytes[at] = '\xff';
        return bytes;
    };
    Offscreen offscreen{Extent{20}, grey, 400, 350, {.slots = 128}};
    const Camera camera{.ground = {9'000'000, 8'000'000, 0, 0},
                        .height_texels = 600,
                        .yaw_degrees = 20,
                        .pitch_degrees = -35};
    offscreen.settle(camera);
    const Rgba8Image plain = offscreen.draw(camera),
                     lined = offscreen.draw(camera, {.overlay = Overlay::level});
    int changed = 0;
    for (std::size_t at = 0; at < plain.bytes.size(); at += 4)
        for (std::size_t c = 0; c < 3; ++c)
            if (std::abs(plain.bytes[at + c] - lined.bytes[at + c]) > 20) {
                ++changed;
                break;
            }
    EXPECT_GT(changed, 400 * 350 / 200);
    EXPECT_LT(changed, 400 * 350 / 8);
}

}  // namespace
}  // namespace tessera
