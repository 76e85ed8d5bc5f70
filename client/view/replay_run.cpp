#include "client/view/replay_run.h"

#include <cstdio>
#include <memory>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "client/render/glfw_window.h"
#include "client/view/png_file.h"
#include "client/view/record/replay.h"

namespace tessera {
namespace {

/// The replay's pictures in a window, as fast as the screen shows them.
bool show(GlfwWindow& window, const FrameTarget& target) {
    const GlfwWindow::Size size = window.framebuffer_size();
    if (size.width != target.width() || size.height != target.height())
        glfwSetWindowSize(window.handle(), target.width(), target.height());
    target.blit_to_window();
    window.swap();
    glfwPollEvents();
    return !window.should_close();
}

}  // namespace

Result<void> run_replay(const Options& options) {
    std::unique_ptr<GlContext> context;
    GlfwWindow* window = nullptr;
    if (options.headless) {
        auto made = make_headless_context();
        if (!made) return made.error();
        context = std::move(*made);
    } else {
        auto made = GlfwWindow::open("Replay - Tessera", {options.width, options.height});
        if (!made) return made.error();
        window = made->get();
        context = std::move(*made);
    }
    if (const auto checked = check_gl_version(); !checked) return checked.error();
    std::error_code ignored;
    if (!options.output.empty()) std::filesystem::create_directories(options.output, ignored);
    Result<void> written;
    int pictures = 0;
    const auto report = replay(options.replay, [&](const FrameTarget& target, std::uint64_t) {
        if (!options.output.empty()) {
            char name[32];
            std::snprintf(name, sizeof name, "frame_%04d.png", pictures++);
            written = write_png(options.output / name, target.read());
        }
        return written && (!window || show(*window, target));
    });
    if (!report) return report.error();
    if (!written) return written.error();
    std::fputs(text_of(*report).c_str(), stdout);
    if (!report->is_equal())
        return Error{ErrorCode::invalid_input, options.replay.string() + ": the replay is not the session"};
    return {};
}

}  // namespace tessera
