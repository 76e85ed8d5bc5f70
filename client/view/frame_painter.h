#pragma once

#include <optional>
#include <vector>

#include "client/render/plane_scene.h"
#include "client/view/view_frame.h"

namespace tessera {

/// Makes pictures of frames: the one way to them for the window, for headless runs and for replays. Needs a
/// current context.
class FramePainter {
  public:
    /// Both outlive this. `second`: of a source with another accuracy, for frames whose split says so; null:
    /// such frames show the first on both sides.
    explicit FramePainter(PlaneScene& scene, PlaneScene* second = nullptr) : scene_{scene}, second_{second} {}

    /// Decides what is resident for the frame, and brings what came to the GPU; of both parts of a split one.
    ResidencyFrame update(const ViewFrame& frame);
    /// Draws the frame of the last update(). Error: io_failure (the driver refuses the filter's shader, or
    /// has no room); nothing is drawn then.
    Result<void> draw(const ViewFrame& frame, const FrameTarget& target);

    const PlaneScene& scene() const { return scene_; }
    PlaneScene& scene() { return scene_; }
    void set_second(PlaneScene* second) { second_ = second; }
    PlaneScene* second() { return second_; }
    const PlaneScene* second() const { return second_; }
    /// Of the last update(), where both parts have a cache of their own: what the second sampled, and how
    /// many of the outcome's uploads, the last ones, were its.
    struct Beside {
        std::vector<NeededPage> sampled;
        std::size_t uploads = 0;
    };
    const std::optional<Beside>& beside() const { return beside_; }

  private:
    PlaneScene& scene_;
    PlaneScene* second_;
    std::optional<Beside> beside_;
};

}  // namespace tessera
