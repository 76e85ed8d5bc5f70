#include "client/render/gl_context.h"

#include <cstdlib>

#include <gmock/gmock.h>

#include "client/render/glfw_window.h"

namespace tessera {
namespace {

TEST(HeadlessContext, IsOpenGl45WithoutAnyDisplay) {
    ASSERT_EQ(std::getenv("DISPLAY"), nullptr) << "run by ctest, which hides the display";
    const auto context = make_headless_context();
    ASSERT_TRUE(context) << context.error().detail;
    EXPECT_TRUE(check_gl_version());
    EXPECT_THAT(gl_description(), ::testing::HasSubstr("OpenGL 4."));
}

TEST(GlfwWindow, SaysWhatToDoWhereThereIsNoDisplay) {
    ASSERT_EQ(std::getenv("DISPLAY"), nullptr) << "run by ctest, which hides the display";
    const auto window = GlfwWindow::open("test", {64, 64}, false);
    ASSERT_FALSE(window);
    EXPECT_THAT(window.error().detail, ::testing::HasSubstr("--headless"));
}

}  // namespace
}  // namespace tessera
