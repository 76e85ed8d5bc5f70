#include "client/view/viewer_window.h"

#define GLFW_INCLUDE_NONE
#include <chrono>
#include <cstdio>
#include <ctime>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include "client/render/glfw_window.h"
#include "client/view/camera_path.h"
#include "client/view/frame_painter.h"
#include "client/view/panels/panels.h"
#include "client/view/png_file.h"
#include "client/view/window_input.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto longest_wait_for_sharpness = std::chrono::seconds{60};

/// ImGui on the window, for as long as this lives.
class Panels {
  public:
    explicit Panels(const GlfwWindow& window) : scale_{window.content_scale()} {
        ImGui::CreateContext();
        style_panels(scale_);
        ImGui_ImplGlfw_InitForOpenGL(window.handle(), true);
        ImGui_ImplOpenGL3_Init("#version 450 core");
    }
    ~Panels() {
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }
    Panels(const Panels&) = delete;
    Panels& operator=(const Panels&) = delete;

    float scale() const { return scale_; }
    void begin() {
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
    }
    /// Draws them on the window's own framebuffer.
    void end() {
        ImGui::Render();
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    }

  private:
    float scale_;
};

class Viewer {
  public:
    Viewer(const Options& options, const SceneInfo& info, const ServerAddress& server, const Camera& start,
           ViewSource& source, GlfwWindow& window, PlaneScene& scene)
        : options_{options},
          info_{info},
          server_{server.authority()},
          source_{source},
          window_{window},
          painter_{scene},
          panels_{window},
          control_{start, info.extent},
          input_{window, control_, start} {
        switches_.filter = options.filter;
    }

    Result<void> run() {
        auto last = Clock::now();
        for (int frame = 0; !window_.should_close();) {
            glfwPollEvents();
            const GlfwWindow::Size size = window_.framebuffer_size();
            if (size.width == 0 || size.height == 0) {  // minimised
                glfwWaitEventsTimeout(0.1);
                continue;
            }
            const auto now = Clock::now();
            const double seconds = std::chrono::duration<double>(now - last).count();
            last = now;
            times_.add(1000 * seconds);
            const bool sharp = draw(size, std::min(seconds, 0.1));
            ++frame;
            const bool waited = Clock::now() - begin_ > longest_wait_for_sharpness;
            if (options_.frames > 0 && frame >= options_.frames && (sharp || waited)) {
                if (!options_.output.empty()) return write_window(options_.output / "window.png");
                break;
            }
            window_.swap();
        }
        return {};
    }

  private:
    bool draw(GlfwWindow::Size size, double seconds) {
        if (!target_ || target_->width() != size.width || target_->height() != size.height)
            target_.emplace(size.width, size.height);
        panels_.begin();
        input_.advance(seconds, switches_);
        glfwSwapInterval(switches_.vsync ? 1 : 0);

        const ViewFrame shown = frame_of(size);
        const PlaneView view = shown.view();
        const ResidencyFrame frame = painter_.update(shown);
        if (const auto drawn = painter_.draw(shown, *target_); !drawn) give_up_filter(drawn.error());
        target_->blit_to_window();
        glBindFramebuffer(GL_FRAMEBUFFER, 0);

        const auto cursor = input_.cursor_pixels();
        PanelContents contents{
            .scene = info_,
            .server = server_,
            .plane = painter_.scene(),
            .view = view,
            .frame = frame,
            .times = times_,
            .cursor = read_cursor(view, painter_.scene().residency(), frame.lod_bias, cursor.x, cursor.y),
            .source = source_.state(),
            .step = shown.time.step,
            .bytes_received = source_.bytes_received(),
            .scale = panels_.scale()};
        draw_panels(contents, switches_);
        panels_.end();
        answer_requests(input_.take_requests());
        return frame.is_sharp();
    }

    ViewFrame frame_of(GlfwWindow::Size size) const {
        const auto now = std::chrono::duration_cast<ClientTime>(Clock::now() - begin_) + ClientTime{1};
        const ViewSource::SceneTime scene_time = source_.scene_time();
        return {.camera = control_.camera(),
                .width = size.width,
                .height = size.height,
                .time = {now, scene_time.step, scene_time.steps_per_second},
                .filter = switches_.filter,
                .fade_ms = switches_.fade ? 150.0F : 0.0F,
                .haze = switches_.haze,
                .overlay = switches_.overlay};
    }

    /// A filter that the driver refuses is left for the one that always works.
    void give_up_filter(const Error& error) {
        if (switches_.filter.filter != Filter::trilinear)
            std::fprintf(stderr, "tessera-view: %s: %s\n", title_of(switches_.filter.filter),
                         error.detail.c_str());
        switches_.filter.filter = Filter::trilinear;
    }

    void answer_requests(const WindowRequests& requests) {
        if (requests.camera_key) {
            std::printf("%s\n", camera_key_json(0, control_.camera()).c_str());
            std::fflush(stdout);  // whoever reads a pipe wants it now
        }
        if (!requests.screenshot && !requests.screenshot_with_panels) return;
        char name[64];
        const std::time_t now = std::time(nullptr);
        std::strftime(name, sizeof name, "tessera-%Y%m%d-%H%M%S.png", std::localtime(&now));
        const auto file = options_.output / name;
        const auto written = requests.screenshot ? write_png(file, target_->read()) : write_window(file);
        if (written)
            std::printf("tessera-view: wrote %s\n", file.c_str());
        else
            std::fprintf(stderr, "tessera-view: %s\n", written.error().detail.c_str());
        std::fflush(stdout);
    }

    /// The window's picture, panels included.
    Result<void> write_window(const std::filesystem::path& file) {
        std::error_code failed;
        if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), failed);
        return write_png(file, read_framebuffer(0, target_->width(), target_->height()));
    }

    const Options& options_;
    const SceneInfo& info_;
    std::string server_;
    ViewSource& source_;
    GlfwWindow& window_;
    FramePainter painter_;
    Panels panels_;
    CameraControl control_;
    WindowInput input_;
    std::optional<FrameTarget> target_;
    ViewerSwitches switches_;
    FrameTimes times_;
    Clock::time_point begin_ = Clock::now();
};

}  // namespace

Result<void> run_window(const Options& options, const SceneInfo& info, const ServerAddress& server,
                        const Camera& start, ViewSource& source) {
    const std::string title = (info.title.empty() ? info.id : info.title) + " - Tessera";
    auto window = GlfwWindow::open(title, {options.width, options.height});
    if (!window) return window.error();
    ResidencySettings settings;
    settings.slots = options.cache_pages;
    settings.requests.in_flight = options.in_flight;
    // The window may grow to the whole screen
    const GLFWvidmode* screen = glfwGetVideoMode(glfwGetPrimaryMonitor());
    settings.window_side = window_side_for(screen ? screen->width : 2400);
    auto scene = PlaneScene::make(info.extent, source, settings);
    if (!scene) return scene.error();
    return Viewer{options, info, server, start, source, **window, **scene}.run();
}

}  // namespace tessera
