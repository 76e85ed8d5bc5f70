#include <gtest/gtest.h>

#include "tests/unit/client/render/offscreen.h"

namespace tessera {
namespace {

using testing::Offscreen;

/// Level 0 is white, all coarser levels black.
std::string white_detail(PageKey page) {
    std::string bytes(slot_bytes, page.level == 0 ? '\xff' : '\0');
    for (std::size_t at = 3; at < bytes.size(); at += 4) bytes[at] = '\xff';
    return bytes;
}

TEST(Fade, BringsNewDetailInGraduallyAndEndsOnTheDetailAlone) {
    Offscreen offscreen{Extent{3}, white_detail, 64, 64, {.slots = 64}};
    const Camera camera{.ground = {700, 700, 0, 0}, .height_texels = 30, .pitch_degrees = -90};
    offscreen.settle(camera);
    const PlaneStyle fading{.fade_ms = 160};
    int last = -1, steps = 0;
    for (int frame = 0; frame < 12; ++frame, offscreen.update(camera)) {
        const int code = offscreen.draw(camera, fading).row(32)[4 * 32];
        EXPECT_GE(code, last);
        steps += code != last ? 1 : 0;
        last = code;
    }
    EXPECT_GE(steps, 5);
    EXPECT_EQ(last, 255);
    EXPECT_EQ(offscreen.draw(camera).row(32)[4 * 32], 255) << "without fading it is there at once";
}

}  // namespace
}  // namespace tessera
