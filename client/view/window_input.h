#pragma once

#include "client/render/glfw_window.h"
#include "client/view/camera_control.h"
#include "client/view/viewer_state.h"
#include "client/view/window_events.h"

namespace tessera {

/// What was asked for by a key, once.
struct WindowRequests {
    bool screenshot = false;
    bool screenshot_with_panels = false;
    bool camera_key = false;
    bool record = false;  ///< Begin or end
    bool play = false;    ///< Begin or end
};

/// Mouse and keyboard of a window -> camera and switches. What the panels take (ImGui) does not come here.
class WindowInput {
  public:
    /// All but `home` outlive this. `home`: where the Home key leads.
    WindowInput(GlfwWindow& window, const WindowEvents& events, CameraControl& control, const Camera& home);

    /// Whether hands steer the camera now.
    bool is_steering() const { return dragging_ >= 0 || is_steering_; }

    /// Once a frame, within ImGui's frame.
    void advance(double seconds, ViewerSwitches& switches);

    /// What is another's in the next advance(): the left button; keys that editors have, too (with Ctrl all,
    /// else arrows, digits, Escape and some letters).
    void withhold(bool left_button, bool editing_keys) {
        no_left_button_ = left_button;
        no_editing_keys_ = editing_keys;
    }

    WindowRequests take_requests() { return std::exchange(requests_, {}); }

    struct Pixels {
        double x = 0;
        double y = 0;
    };
    /// The cursor in the framebuffer, from its top-left corner.
    Pixels cursor_pixels() const;

  private:
    void mouse(ViewerSwitches& switches);
    bool is_on_split(const ViewerSwitches& switches, const Pixels& cursor) const;
    void keys(ViewerSwitches& switches);
    CameraControl::Steering steering() const;
    bool is_down(int key) const { return events_.is_down(key); }
    void toggle_full_screen();

    GlfwWindow& window_;
    const WindowEvents& events_;
    CameraControl& control_;
    Camera home_;
    WindowRequests requests_;
    Pixels last_cursor_;
    bool is_steering_ = false;
    bool no_left_button_ = false, no_editing_keys_ = false;
    bool drags_split_ = false;
    int dragging_ = -1;  ///< The mouse button that is held, or −1
    int window_place_[4] = {100, 100, 1280, 800};
};

}  // namespace tessera
