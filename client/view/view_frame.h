#pragma once

#include "client/render/filter.h"
#include "client/residency/plane_view.h"
#include "client/residency/residency.h"

namespace tessera {

/// All that decides one frame's picture, but for what its page source has brought by then: a session that is
/// recorded is a row of these with what came between them, and is drawn again from nothing else.
struct ViewFrame {
    Camera camera{};
    int width = 0;  ///< Pixels
    int height = 0;
    FrameTime time{ClientTime{0}};
    FilterChoice filter{};
    float fade_ms = 0;          ///< See PlaneStyle
    bool haze = true;           ///< See PlaneStyle
    bool page_borders = false;  ///< See PlaneStyle

    PlaneView view() const { return {camera, width, height}; }
};

}  // namespace tessera
