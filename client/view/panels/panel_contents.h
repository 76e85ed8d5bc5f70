#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/link/scene_info.h"
#include "client/render/plane_scene.h"
#include "client/view/panels/panel_columns.h"
#include "client/view/view_source.h"
#include "client/view/viewer_state.h"

namespace tessera {

class SessionMetrics;

/// What one frame's panels show.
struct PanelContents {
    const SceneInfo& scene;
    const std::string& server;
    const PlaneScene& plane;
    const PlaneView& view;
    const ResidencyFrame& frame;
    const FrameTimes& times;
    const SessionMetrics& metrics;
    std::optional<CursorReading> cursor;
    ViewSource::State source{};
    Step step = 0;  ///< Of the scene's clock
    std::uint64_t bytes_received = 0;
    float scale = 1;            ///< The screen's content scale
    bool is_recording = false;  ///< The camera's way
    bool is_playing = false;
    PanelRoom room{};
    struct Notice {
        std::string words{};  ///< What a key just did; empty: nothing
        bool is_good = true;
    };
    Notice notice{};
};

}  // namespace tessera
