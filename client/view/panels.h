#pragma once

#include <cstdint>
#include <string>

#include "client/link/scene_info.h"
#include "client/render/plane_scene.h"
#include "client/view/view_source.h"
#include "client/view/viewer_state.h"

namespace tessera {

/// Fonts, colours and sizes of the panels, for a screen of this scale. Once, after ImGui's context is made.
void style_panels(float content_scale);

/// What one frame's panels show.
struct PanelContents {
    const SceneInfo& scene;
    const std::string& server;
    const PlaneScene& plane;
    const PlaneView& view;
    const ResidencyFrame& frame;
    const FrameTimes& times;
    std::optional<CursorReading> cursor;
    ViewSource::State source{};
    Step step = 0;  ///< Of the scene's clock
    std::uint64_t bytes_received = 0;
    float scale = 1;  ///< The screen's content scale
};

/// The panel on the left, the message in the corner while the server is in trouble, and the help, as
/// switched.
void draw_panels(const PanelContents& contents, ViewerSwitches& switches);

}  // namespace tessera
