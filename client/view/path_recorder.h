#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "client/view/camera_path.h"

namespace tessera {

/// The camera's way as keys of a camera path, while it is recorded; and a path that is played.
class PathRecorder {
  public:
    /// Once a frame, `seconds` later than the frame before: notes the camera while recording, and while
    /// playing says where it is now; nothing once the path has ended.
    std::optional<Camera> advance(double seconds, const Camera& camera);

    bool is_recording() const { return is_recording_; }
    void start_recording();
    /// What was recorded, as a file that `--camera` takes; empty if it was nothing.
    std::string stop_recording();

    bool is_playing() const { return playing_.has_value(); }
    void play(const CameraPath& path);
    void stop_playing() { playing_.reset(); }

  private:
    struct Noted {
        double seconds = 0;
        Camera camera{};
    };
    bool is_recording_ = false;
    double seconds_ = 0;
    std::vector<Noted> noted_;
    std::optional<CameraPath> playing_;
    double played_ = 0;
};

}  // namespace tessera
