#pragma once

#include <optional>

#include "client/residency/camera.h"
#include "client/residency/credit_window.h"
#include "shared/page/page_key.h"

namespace tessera {

/// How the camera moves, from the frames so far, and where it will be soon: what is asked for now is seen
/// only when it arrives.
class CameraMotion {
  public:
    /// Once a frame.
    void observe(const Camera& camera, ClientTime now);

    /// The camera in so long, if it goes on like this; inside the extent. Nothing while it rests, and after a
    /// leap.
    std::optional<Camera> in(ClientTime ahead, Extent extent) const;

  private:
    /// Per millisecond; the ground in eye heights, the height as the logarithm of its factor.
    struct Speed {
        double x = 0, y = 0, height = 0, yaw = 0, pitch = 0;
    };
    Camera last_{};
    ClientTime last_time_{};
    bool is_known_ = false;
    Speed speed_{};
};

}  // namespace tessera
