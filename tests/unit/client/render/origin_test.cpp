#include <gtest/gtest.h>

#include "tests/unit/client/render/offscreen.h"
#include "tests/unit/client/render/painted_pages.h"

namespace tessera {
namespace {

using testing::Code4;
using testing::Offscreen;

/// Noise that repeats every 2^24 texels of level 0 along both axes.
Code4 periodic_texel(int level, std::int64_t x, std::int64_t y) {
    const std::int64_t mask = level < 24 ? (std::int64_t{1} << (24 - level)) - 1 : 0;
    return testing::noise_texel(level, x & mask, y & mask);
}

Rgba8Image frame_at(std::int64_t x, std::int64_t y, double pitch) {
    const auto paint = [](PageKey page) { return testing::paint_page(page, periodic_texel); };
    Offscreen offscreen{Extent{30}, paint, 320, 280, {.slots = 128}};
    const Camera camera{.ground = {x + (1 << 23) + 12'345, y + (1 << 23) + 54'321, 0.375, 0.8125},
                        .height_texels = 333,
                        .yaw_degrees = 37,
                        .pitch_degrees = pitch};
    offscreen.settle(camera);
    return offscreen.draw(camera);
}

TEST(Origin, IsNotToBeSeenAFrameAtTexel2ToThe37EqualsOneAtZeroToTheLastBit) {
    constexpr std::int64_t far = std::int64_t{1} << 37;
    for (const double pitch : {-80.0, -30.0}) {
        const Rgba8Image near = frame_at(0, 0, pitch);
        EXPECT_EQ(near, frame_at(far, far, pitch)) << "pitch " << pitch;
        EXPECT_EQ(near, frame_at(0, far - (1 << 24), pitch)) << "pitch " << pitch;
    }
}

}  // namespace
}  // namespace tessera
