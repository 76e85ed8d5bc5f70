#include <gmock/gmock.h>

#include "tests/end_to_end/view/scene_server.h"

namespace tessera {
namespace {

using namespace tessera::testing;

TEST(ViewWindow, OpensDrawsAndLeavesAPictureOfItselfUnderXvfb) {
    const SceneServer server;
    const auto out = server.folder() / "window";
    Program program{{XVFB_RUN, "-a", "-s", "-screen 0 1280x1024x24", VIEW_PROGRAM, server.url(), "board",
                     "--size", "640x480", "--frames", "5", "-o", out.string()}};
    const Program::Ended ended = program.end();
    EXPECT_EQ(ended.exit_code, 0) << ended.error;
    ASSERT_TRUE(std::filesystem::exists(out / "window.png")) << ended.error;
    EXPECT_GT(std::filesystem::file_size(out / "window.png"), 10'000u);
}

}  // namespace
}  // namespace tessera
