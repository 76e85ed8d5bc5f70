// Runs under Xvfb: the window's context draws the same pixels as the headless one.
#include <gtest/gtest.h>

#include "client/render/glfw_window.h"
#include "tests/unit/client/render/offscreen.h"
#include "tests/unit/client/render/painted_pages.h"

namespace tessera {
namespace {

using testing::Offscreen;

Rgba8Image frame(std::unique_ptr<GlContext> context) {
    const auto paint = [](PageKey page) { return testing::paint_page(page, testing::noise_texel); };
    Offscreen offscreen{Extent{20}, paint, 320, 280, {.slots = 128}, std::move(context)};
    const Camera camera{.ground = {9'000'000, 8'000'000, 0, 0},
                        .height_texels = 600,
                        .yaw_degrees = 20,
                        .pitch_degrees = -20};
    offscreen.settle(camera);
    return offscreen.draw(camera);
}

TEST(Window, DrawsTheSamePixelsAsTheHeadlessContext) {
    auto window = GlfwWindow::open("Tessera window test", {320, 280}, false);
    ASSERT_TRUE(window) << window.error().detail;
    EXPECT_EQ((*window)->framebuffer_size(), (GlfwWindow::Size{320, 280}));
    EXPECT_GT((*window)->content_scale(), 0);
    const Rgba8Image in_window = frame(std::move(window.value()));
    EXPECT_EQ(in_window, frame(testing::headless_context()));
}

}  // namespace
}  // namespace tessera
