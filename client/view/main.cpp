// tessera-view: the GL client.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>

#include <unistd.h>

#include "client/render/gl_context.h"
#include "client/view/compare_filters.h"
#include "client/view/compare_report.h"
#include "client/view/headless_run.h"
#include "client/view/height_image_file.h"
#include "client/view/http_page_source.h"
#include "client/view/options.h"
#include "client/view/replay_run.h"
#include "client/view/stream_page_source.h"
#include "client/view/viewer_window.h"

namespace tessera {
namespace {

ResidencySettings residency_settings(const Options& options) {
    ResidencySettings settings;
    settings.slots = options.cache_pages;
    settings.window_side = window_side_for(options.width);
    settings.requests.in_flight = options.in_flight;
    return settings;
}

Result<CameraPath> camera_path(const Options& options, const SceneInfo& scene) {
    if (!options.camera.empty()) return CameraPath::read(options.camera, scene.extent);
    if (scene.view) return CameraPath{first_camera(*scene.view, scene.extent, options.height)};
    return CameraPath{first_camera(scene.extent)};
}

/// A line every five seconds, for whoever waits.
std::function<void(int)> progress_lines(int frames) {
    using Clock = std::chrono::steady_clock;
    static constexpr auto every = std::chrono::seconds{5};
    return [frames, begin = Clock::now(), next = Clock::now() + every](int done) mutable {
        if (Clock::now() < next || done == frames) return;
        next = Clock::now() + every;
        std::fprintf(stderr, "tessera-view: %d of %d frames, %.0f s\n", done, frames,
                     std::chrono::duration<double>(Clock::now() - begin).count());
    };
}

/// As the options say; a corridor stands around the first camera.
/// How long a server that answers may be busy before the viewer gives up.
constexpr std::chrono::seconds server_patience{60};

Result<Surface> surface_of(const Options& options, const Camera& first) {
    Surface surface = options.surface;
    if (!options.terrain.empty()) {
        auto heights = read_height_image(options.terrain);
        if (!heights) return heights.error();
        surface.heights = std::move(*heights);
    }
    return around(surface, first);
}

Result<void> draw_headless(const Options& options, const SceneInfo& info, const CameraPath& path,
                           const Surface& surface, ViewSource& source, ViewSource* second_source) {
    const auto context = make_headless_context();
    if (!context) return context.error();
    if (const auto checked = check_gl_version(); !checked) return checked.error();
    const auto log = SessionLog::open(options.log);
    if (!log) return log.error();
    const ResidencySettings settings = residency_settings(options);
    auto scene =
        PlaneScene::make(info.extent, (*log)->begin(info.id, info.extent, source, settings), settings);
    if (!scene) return scene.error();
    std::unique_ptr<PlaneScene> second;
    if (second_source) {
        auto made = PlaneScene::make(info.extent, (*log)->begin_second(*second_source, settings), settings);
        if (!made) return made.error();
        second = std::move(*made);
    }
    const HeadlessJob job{.path = path,
                          .frames = options.frames,
                          .width = options.width,
                          .height = options.height,
                          .settle = options.settle,
                          .filter = options.filter,
                          .surface = surface,
                          .overlay = options.overlay,
                          .split = split_of(options),
                          .folder = options.output,
                          .log = log->get(),
                          .source = &source,
                          .step = options.step,
                          .progress = progress_lines(options.frames)};
    auto metrics =
        run_headless(job, FramePainter{**scene, second.get()}, [&](auto timeout) { source.wait(timeout); });
    if (const std::string problem = (*log)->end(); !problem.empty())
        std::fprintf(stderr, "tessera-view: %s\n", problem.c_str());
    if (!metrics) {
        const std::string trouble = source.state().trouble;
        return trouble.empty() ? metrics.error()
                               : Error{metrics.error().code, metrics.error().detail + "; " + trouble};
    }
    metrics->set_scene(info.id);
    metrics->mutable_totals()->set_megabytes_received(static_cast<double>(source.bytes_received()) / 1e6);
    if (const auto written = write_metrics(job, *metrics); !written) return written.error();
    std::printf("tessera-view: %d frames of %dx%d in %s, %.2f s; %u pages, %.1f MB\n", options.frames,
                options.width, options.height, options.output.c_str(), metrics->totals().seconds(),
                metrics->totals().arrived(), metrics->totals().megabytes_received());
    return {};
}

Result<void> compare(const Options& options) {
    std::vector<CompareTexture> textures{made_checker()};
    if (!options.textures.empty()) {
        auto read = read_textures(options.textures);
        if (!read) return read.error();
        textures = std::move(*read);
    }
    for (const CompareTexture& texture : textures)
        if (!texture.cropped.empty()) std::fprintf(stderr, "tessera-view: %s\n", texture.cropped.c_str());
    const auto context = make_headless_context();
    if (!context) return context.error();
    if (const auto checked = check_gl_version(); !checked) return checked.error();
    const bool is_watched = isatty(STDERR_FILENO) != 0;
    const auto report = compare_filters({.textures = std::move(textures),
                                         .width = options.width,
                                         .height = options.height,
                                         .folder = options.output,
                                         .command = options.command_line},
                                        [&](const std::string& doing) {
                                            if (is_watched) std::fprintf(stderr, "\r\33[K%s", doing.c_str());
                                        });
    if (is_watched) std::fputs("\r\33[K", stderr);
    if (!report) return report.error();
    std::printf("%stessera-view: %d rows in %s\n", table_of(*report).c_str(), report->rows_size(),
                (options.output / "report.json").c_str());
    return {};
}

std::unique_ptr<ViewSource> make_source(const Options& options, const ServerAddress& server,
                                        const SceneInfo& info, Accuracy accuracy) {
    if (options.http)
        return std::make_unique<HttpPageSource>(server, info, options.channels,
                                                std::min<std::size_t>(options.in_flight, 8), accuracy);
    return std::make_unique<StreamPageSource>(server, info, options.channels, options.name, options.token,
                                              accuracy);
}

Result<void> run(const Options& options) {
    if (options.compare_filters) return compare(options);
    if (!options.replay.empty()) return run_replay(options);
    const auto server = parse_server_address(options.url);
    if (!server) return server.error();
    const auto info = await_scene_info(*server, options.scene, server_patience, [] {
        std::fputs("tessera-view: the server is busy, perhaps it loads its scenes; waiting for it\n", stderr);
    });
    if (!info) return info.error();
    if (const auto checked = check_scene(*info); !checked) return checked.error();
    if (const auto there = check_channels(*info, options.channels); !there) return there.error();
    if (const auto there = check_step(*info, options.step.value_or(0)); !there) return there.error();
    const auto path = camera_path(options, *info);
    if (!path) return path.error();
    const auto surface = surface_of(options, path->at(path->begin_seconds()));
    if (!surface) return surface.error();
    const auto source = make_source(options, *server, *info, options.accuracy);
    std::unique_ptr<ViewSource> second;
    if (options.split_accuracy && options.headless)
        second = make_source(options, *server, *info, *options.split_accuracy);
    if (options.headless) return draw_headless(options, *info, *path, *surface, *source, second.get());
    return run_window(options, *info, *server, *path, *surface, *source,
                      [&](Accuracy accuracy) { return make_source(options, *server, *info, accuracy); });
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
    tessera::Options options;
    int exit_code = 0;
    if (!tessera::read_options(argc, argv, options, exit_code)) return exit_code;
    if (const auto done = tessera::run(options); !done) {
        std::fprintf(stderr, "tessera-view: %s\n", done.error().detail.c_str());
        return 1;
    }
    return 0;
}
