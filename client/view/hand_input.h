#pragma once

#include <optional>
#include <string>

#include "client/view/hand_desk.h"
#include "client/view/hand_view.h"
#include "client/view/window_events.h"

namespace tessera {

/// Where the brush is over no entry of its map: so, and where the map is. Empty: it may paint.
std::string why_not_paint(HandDesk& desk);

/// Mouse and keys of a window for the hand: what it takes, the camera does not get.
class HandInput {
  public:
    /// Both outlive this.
    HandInput(const WindowEvents& events, HandDesk& desk) : events_{events}, desk_{desk} {}

    /// Once a frame, within ImGui's, before the camera's input. `view`: the last frame's picture; pixels are
    /// the framebuffer's.
    void advance(const HandPicture& view, double cursor_x, double cursor_y, Extent extent, int level);

    /// Whether the left button drags something, so that it does not move the camera.
    bool has_mouse() const { return has_mouse_; }
    /// Whether keys without Ctrl that the camera has, too, are the hand's now: arrows, R, 1 to 9, Escape,
    /// also the one that has closed the editor in this frame.
    bool has_keys() const { return desk_.is_open || took_escape_; }

  private:
    void keys(double texels_per_pixel);
    void sprite_keys(double texels_per_pixel);
    void press(const HandPoint& at, double texels_per_pixel);
    void drag(bool is_down, bool snap);
    void let_go();
    bool escape();

    const WindowEvents& events_;
    HandDesk& desk_;
    bool has_mouse_ = false, is_down_ = false, was_button_ = false, moved_ = false, took_escape_ = false;
    double start_x_ = 0, start_y_ = 0;
    HandDesk::Tool tool_ = HandDesk::Tool::hand;  ///< That the button went down with
    std::optional<HandPoint> last_;
};

}  // namespace tessera
