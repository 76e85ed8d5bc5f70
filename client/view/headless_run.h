#pragma once

#include <chrono>
#include <filesystem>
#include <functional>

#include "client/render/plane_scene.h"
#include "client/view/camera_path.h"
#include "client/view/frame_painter.h"
#include "client/view/session_log.h"
#include "client/view/view.pb.h"

namespace tessera {

struct HeadlessJob {
    CameraPath path;
    int frames = 1;   ///< At least 1, spread evenly from the path's begin to its end.
    int width = 800;  ///< Pixels, 16 to 8192
    int height = 700;
    bool settle = true;  ///< Each frame waits until every page it needs is there.
    FilterChoice filter{};
    Surface surface{};
    Overlay overlay = Overlay::none;
    std::optional<SplitChoice> split{};
    std::filesystem::path folder;
    /// Told of every frame; null: nobody.
    SessionLog* log = nullptr;
    /// What moves the scene's clock, and what the link says; null: nothing does.
    const ViewSource* source = nullptr;
    std::optional<Step>
        step{};  ///< Of all frames; none: the source's, where frames settle as it was at first
    /// Called after each frame with how many are done; null: nobody asks.
    std::function<void(int frames)> progress{};
    std::chrono::milliseconds patience{60'000};  ///< Without any page arriving, before a frame gives up.
};

/// Draws the frames of a camera path, and writes frame_0000.png … and metrics.json into the job's folder,
/// which is made if need be. Needs a current context. `wait` waits for the source's next arrival, at most so
/// long. Error: io_failure (cannot write; the pages do not come).
Result<view::RunMetrics> run_headless(const HeadlessJob& job, FramePainter painter,
                                      const std::function<void(std::chrono::milliseconds)>& wait);

/// Writes metrics.json into the job's folder.
Result<void> write_metrics(const HeadlessJob& job, const view::RunMetrics& metrics);

}  // namespace tessera
