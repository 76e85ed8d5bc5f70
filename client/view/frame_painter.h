#pragma once

#include "client/render/plane_scene.h"
#include "client/view/view_frame.h"

namespace tessera {

/// Makes pictures of frames: the one way to them for the window, for headless runs and for replays. Needs a
/// current context.
class FramePainter {
  public:
    /// `scene` outlives this.
    explicit FramePainter(PlaneScene& scene) : scene_{scene} {}

    /// Decides what is resident for the frame, and brings what came to the GPU.
    ResidencyFrame update(const ViewFrame& frame);
    /// Draws the frame of the last update(). Error: io_failure (the driver refuses the filter's shader, or
    /// has no room); nothing is drawn then.
    Result<void> draw(const ViewFrame& frame, const FrameTarget& target);

    const PlaneScene& scene() const { return scene_; }
    PlaneScene& scene() { return scene_; }

  private:
    PlaneScene& scene_;
};

}  // namespace tessera
