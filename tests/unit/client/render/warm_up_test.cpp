#include <gtest/gtest.h>

#include "tests/unit/client/render/offscreen.h"
#include "tests/unit/client/render/painted_pages.h"

namespace tessera {
namespace {

using testing::Offscreen;

TEST(WarmUp, ChangesNeitherThePictureNorWhatIsHeldOfPages) {
    const auto waves = [](PageKey page) {
        return testing::paint_page(page, [](int level, std::int64_t x, std::int64_t y) -> testing::Code4 {
            const auto code = static_cast<std::uint8_t>((x << level >> 5) + (y << level >> 6));
            return {code, static_cast<std::uint8_t>(255 - code), 90, 255};
        });
    };
    const Camera camera{.ground = {9'000'000, 8'000'000, 0, 0},
                        .height_texels = 600,
                        .yaw_degrees = 20,
                        .pitch_degrees = -14};
    for (const Filter filter : {Filter::trilinear, Filter::anisotropic, Filter::line_integral}) {
        Offscreen offscreen{Extent{20}, waves, 160, 140, {.slots = 256}};
        offscreen.settle(camera, {.filter = filter});
        const Rgba8Image before = offscreen.draw(camera);
        const std::size_t bytes = offscreen.scene->gpu_bytes();
        const auto warm = offscreen.scene->warm_up(offscreen.view(camera), {.filter = filter});
        ASSERT_TRUE(warm) << warm.error().detail;
        EXPECT_EQ(offscreen.scene->gpu_bytes(), bytes);
        EXPECT_EQ(offscreen.draw(camera).bytes, before.bytes);
        // And the filter itself shows what it shows without
        const Rgba8Image shown = offscreen.draw(camera, {.filter = {.filter = filter}});
        Offscreen cold{Extent{20}, waves, 160, 140, {.slots = 256}};
        cold.settle(camera, {.filter = filter});
        EXPECT_EQ(cold.draw(camera, {.filter = {.filter = filter}}).bytes, shown.bytes) << name_of(filter);
    }
}

}  // namespace
}  // namespace tessera
