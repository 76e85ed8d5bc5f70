#include "client/view/viewer_window.h"

#define GLFW_INCLUDE_NONE
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include "client/render/glfw_window.h"
#include "client/view/camera_path.h"
#include "client/view/frame_painter.h"
#include "client/view/panels/panels.h"
#include "client/view/path_recorder.h"
#include "client/view/png_file.h"
#include "client/view/session_log.h"
#include "client/view/warm_up.h"
#include "client/view/window_hands.h"
#include "client/view/window_input.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto longest_wait_for_sharpness = std::chrono::seconds{60};
constexpr auto notice_lasts = std::chrono::seconds{4};

/// ImGui on the window, for as long as this lives.
class Panels {
  public:
    /// `larger`: than the screen asks.
    Panels(const GlfwWindow& window, WindowEvents& events, float larger)
        : window_{window}, events_{events}, larger_{larger}, scale_{larger * window.content_scale()} {
        events.listen(window.handle());
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
        // Another screen, or its settings
        if (const float scale = larger_ * window_.content_scale(); scale != scale_) {
            scale_ = scale;
            style_panels(scale);
            ImGui_ImplOpenGL3_DestroyFontsTexture();
            ImGui_ImplOpenGL3_CreateFontsTexture();
        }
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        events_.tell(ImGui::GetIO());
        ImGui::NewFrame();
    }
    /// Draws them on the window's own framebuffer.
    void end() {
        ImGui::Render();
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    }

  private:
    const GlfwWindow& window_;
    const WindowEvents& events_;
    float larger_;
    float scale_;
};

/// The pages of a split picture's right part, where these are of another accuracy.
struct SecondScene {
    Accuracy accuracy;
    std::unique_ptr<ViewSource> source;
    std::unique_ptr<PlaneScene> scene;
};

using SourceOf = std::function<std::unique_ptr<ViewSource>(Accuracy)>;

class Viewer {
  public:
    Viewer(const Options& options, const SceneInfo& info, const ServerAddress& server, const CameraPath& path,
           const Surface& surface, ViewSource& source, const SourceOf& source_of, GlfwWindow& window,
           PlaneScene& scene, SessionLog& log)
        : options_{options},
          info_{info},
          server_{server.authority()},
          source_{source},
          window_{window},
          painter_{scene},
          source_of_{source_of},
          log_{log},
          panels_{window, events_, static_cast<float>(options.panel_scale)},
          control_{path.at(path.begin_seconds()), info.extent},
          input_{window, events_, control_, path.at(path.begin_seconds())},
          hands_{source, server, info, options.name, events_} {
        switches_.filter = options.filter;
        switches_.surface = surface;
        switches_.overlay = options.overlay;
        switches_.split = split_of(options);
        switches_.cache_pages = cache_pages_ = options.cache_pages;
        switches_.accuracy = options.accuracy;
        switches_.split_accuracy = options.split_accuracy.value_or(Accuracy::exact);
        if (path.end_seconds() > path.begin_seconds()) path_ = path;
    }

    Result<void> run() {
        auto last = Clock::now();
        for (int frame = 0; !window_.should_close();) {
            glfwPollEvents();
            events_.next_frame();
            const GlfwWindow::Size size = window_.framebuffer_size();
            if (size.width == 0 || size.height == 0) {  // minimised
                glfwWaitEventsTimeout(0.1);
                continue;
            }
            const auto now = Clock::now();
            const double seconds = std::chrono::duration<double>(now - last).count();
            last = now;
            times_.add(1000 * seconds);
            frame_ms_ = 1000 * seconds;
            const bool sharp = draw(size, std::min(seconds, 0.1));
            ++frame;
            const bool waited = Clock::now() - begin_ > longest_wait_for_sharpness;
            if (options_.frames > 0 && frame >= options_.frames && (sharp || waited)) {
                if (!options_.output.empty()) return write_window(options_.output / "window.png");
                break;
            }
            window_.swap();
            const bool at_rest = sharp && options_.frames == 0 && !input_.is_steering() &&
                                 !recorder_.is_playing() && !hands_.has_mouse();
            if (warm_up_.advance(at_rest, now, painter_.scene(), last_frame_.view())) last = Clock::now();
        }
        return {};
    }

  private:
    bool draw(GlfwWindow::Size size, double seconds) {
        if (!target_ || target_->width() != size.width || target_->height() != size.height)
            target_.emplace(size.width, size.height);
        panels_.begin();
        const auto hand_at = input_.cursor_pixels();
        hands_.advance(last_frame_, info_.extent, hand_at.x, hand_at.y);
        input_.withhold(hands_.has_mouse(), hands_.has_keys());
        input_.advance(seconds, switches_);
        control_.set_surface(switches_.surface);
        if (input_.is_steering()) recorder_.stop_playing();
        if (const auto played = recorder_.advance(seconds, control_.camera())) control_.set(*played);
        glfwSwapInterval(switches_.vsync ? 1 : 0);
        bring_second();
        resize_cache();

        const auto begin = Clock::now();
        ViewFrame shown = frame_of(size);
        hands_.fill(shown);
        hands_.bring_pictures(painter_.scene(), painter_.second(),
                              [&](std::int32_t pattern, const Rgba8Image& picture, double side) {
                                  log_.pattern(pattern, picture, side);
                              });
        const PlaneView view = shown.view();
        const ResidencyFrame frame = painter_.update(shown);
        log_.updated(shown);
        if (const auto drawn = painter_.draw(shown, *target_); !drawn) give_up_filter(drawn.error());
        log_.drawn(*target_);
        log_.measured(shown, frame, painter_,
                      {.frame_ms = frame_ms_,
                       .work_ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count(),
                       .bytes_received = source_.bytes_received(),
                       .link = source_.state()});
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
            .metrics = log_.metrics(),
            .cursor = read_cursor(view, residency_at(shown, cursor.x), frame.lod_bias, cursor.x, cursor.y),
            .source = source_.state(),
            .step = shown.time.step,
            .bytes_received = source_.bytes_received(),
            .scale = panels_.scale(),
            .is_recording = recorder_.is_recording(),
            .is_playing = recorder_.is_playing(),
            .notice = Clock::now() < notice_until_ ? notice_ : PanelContents::Notice{}};
        hands_.drawn(frame);
        contents.room =
            hands_.draw_panels(view, panels_.scale(),
                               static_cast<float>(size.width) / std::max(ImGui::GetIO().DisplaySize.x, 1.0F));
        last_frame_ = shown;
        draw_panels(contents, switches_);
        panels_.end();
        answer_requests(input_.take_requests());
        tell_title();
        return frame.is_sharp();
    }

    /// What the right part of a split picture needs, while there is one with pages of its own.
    void bring_second() {
        const bool is_wanted = switches_.split && switches_.split->is_second;
        if (second_ && (!is_wanted || second_->accuracy != switches_.split_accuracy)) {
            painter_.set_second(nullptr);
            second_.reset();
            log_.end_second();
        }
        if (second_ || !is_wanted) return;
        SecondScene made{switches_.split_accuracy, source_of_(switches_.split_accuracy), nullptr};
        const ResidencySettings settings = painter_.scene().residency().settings();
        auto scene = PlaneScene::make(info_.extent, log_.begin_second(*made.source, settings), settings);
        if (!scene) {
            log_.end_second();
            std::fprintf(stderr, "tessera-view: %s\n", scene.error().detail.c_str());
            switches_.split.reset();
            return;
        }
        made.scene = std::move(*scene);
        second_ = std::make_unique<SecondScene>(std::move(made));
        painter_.set_second(second_->scene.get());
    }

    void resize_cache() {
        if (switches_.cache_pages == cache_pages_) return;
        const std::size_t before = std::exchange(cache_pages_, switches_.cache_pages);
        const auto resize = [&](std::size_t pages) {
            auto done = painter_.scene().resize(pages);
            if (done && second_) done = second_->scene->resize(pages);
            return done;
        };
        if (const auto done = resize(cache_pages_); !done) {
            tell(done.error().detail, false);
            switches_.cache_pages = cache_pages_ = before;
            static_cast<void>(painter_.scene().resize(before));
        }
        log_.resized(cache_pages_);
    }

    const Residency& residency_at(const ViewFrame& frame, double x) const {
        const bool is_second = second_ && frame.split && frame.split->is_second && x >= frame.split_column();
        return is_second ? second_->scene->residency() : painter_.scene().residency();
    }

    /// "Pebbles - terrain - trilinear - 60 fps - Tessera", twice a second.
    void tell_title() {
        if (Clock::now() - told_title_ < std::chrono::milliseconds{500}) return;
        told_title_ = Clock::now();
        const double mean = times_.mean_milliseconds();
        char text[160];
        std::snprintf(text, sizeof text, "%s - %s - %s - %.0f fps - Tessera",
                      (info_.title.empty() ? info_.id : info_.title).substr(0, 60).c_str(),
                      std::string{name_of(switches_.surface.kind)}.c_str(), title_of(switches_.filter.filter),
                      mean > 0 ? 1000 / mean : 0);
        window_.set_title(text);
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
                .overlay = switches_.overlay,
                .surface = switches_.surface,
                .split = switches_.split,
                .most_uploads = painter_.scene().upload_budget().pages()};
    }

    /// A filter that the driver refuses is left for the one that always works.
    void give_up_filter(const Error& error) {
        // Of a split picture nobody knows which side it was
        if (switches_.split)
            tell("split: " + error.detail + "; trilinear is shown", false);
        else if (switches_.filter.filter != Filter::trilinear)
            tell(
                std::string{title_of(switches_.filter.filter)} + ": " + error.detail + "; trilinear is shown",
                false);
        switches_.split.reset();
        switches_.filter.filter = Filter::trilinear;
    }

    void answer_requests(const WindowRequests& requests) {
        if (requests.camera_key) {
            std::printf("%s\n", camera_key_json(0, control_.camera()).c_str());
            std::fflush(stdout);  // whoever reads a pipe wants it now
        }
        if (requests.record) switch_recording();
        if (requests.play && recorder_.is_playing())
            recorder_.stop_playing();
        else if (requests.play && path_)
            recorder_.play(*path_);
        if (!requests.screenshot && !requests.screenshot_with_panels) return;
        const auto file = new_file(".png");
        const auto written = requests.screenshot ? write_png(file, target_->read()) : write_window(file);
        tell(written ? "wrote " + file.string() : written.error().detail, static_cast<bool>(written));
    }

    /// To whoever started the program, and for some seconds in the window.
    void tell(const std::string& words, bool is_good) {
        std::fprintf(is_good ? stdout : stderr, "tessera-view: %s\n", words.c_str());
        std::fflush(stdout);  // whoever reads a pipe wants it now
        notice_ = {words, is_good};
        notice_until_ = Clock::now() + notice_lasts;
    }

    /// In the folder for output, which is there then if it can be.
    std::filesystem::path new_file(const char* ending) const {
        std::error_code ignored;
        if (!options_.output.empty()) std::filesystem::create_directories(options_.output, ignored);
        return options_.output / file_name(ending);
    }

    static std::string file_name(const char* ending) {
        char name[64];
        const std::time_t now = std::time(nullptr);
        std::strftime(name, sizeof name, "tessera-%Y%m%d-%H%M%S", std::localtime(&now));
        return name + std::string{ending};
    }

    void switch_recording() {
        if (!recorder_.is_recording()) return recorder_.start_recording();
        const std::string keys = recorder_.stop_recording();
        const auto file = new_file(".json");
        if (const auto path = CameraPath::parse(keys, file.string(), info_.extent)) path_ = *path;
        std::ofstream stream{file, std::ios::binary};
        stream << keys << std::flush;
        tell((stream ? "wrote " : "cannot write ") + file.string(), static_cast<bool>(stream));
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
    SourceOf source_of_;
    SessionLog& log_;
    std::unique_ptr<SecondScene> second_;
    WindowEvents events_;
    Panels panels_;
    CameraControl control_;
    WindowInput input_;
    WindowHands hands_;
    ViewFrame last_frame_{};
    WarmUp warm_up_;
    std::optional<FrameTarget> target_;
    ViewerSwitches switches_;
    FrameTimes times_;
    PathRecorder recorder_;
    std::optional<CameraPath> path_;  ///< To play
    Clock::time_point begin_ = Clock::now();
    Clock::time_point told_title_{};
    PanelContents::Notice notice_;
    Clock::time_point notice_until_{};
    double frame_ms_ = 0;          ///< Since the frame before
    std::size_t cache_pages_ = 0;  ///< As was asked for last
};

}  // namespace

Result<void> run_window(const Options& options, const SceneInfo& info, const ServerAddress& server,
                        const CameraPath& path, const Surface& surface, ViewSource& source,
                        const SourceOf& source_of) {
    const std::string title = (info.title.empty() ? info.id : info.title) + " - Tessera";
    auto window = GlfwWindow::open(title, {options.width, options.height});
    if (!window) return window.error();
    ResidencySettings settings;
    settings.slots = options.cache_pages;
    settings.requests.in_flight = options.in_flight;
    // The window may grow to the whole screen
    const GLFWvidmode* screen = glfwGetVideoMode(glfwGetPrimaryMonitor());
    settings.window_side = window_side_for(screen ? screen->width : 2400);
    const auto log = SessionLog::open(options.log);
    if (!log) return log.error();
    auto scene =
        PlaneScene::make(info.extent, (*log)->begin(info.id, info.extent, source, settings), settings);
    if (!scene) return scene.error();
    const auto done =
        Viewer{options, info, server, path, surface, source, source_of, **window, **scene, **log}.run();
    if (const std::string problem = (*log)->end(); !problem.empty())
        std::fprintf(stderr, "tessera-view: %s\n", problem.c_str());
    return done;
}

}  // namespace tessera
