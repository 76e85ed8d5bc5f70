#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "client/link/scene_info.h"
#include "client/link/server_address.h"
#include "client/render/plane_scene.h"
#include "client/view/hand_desk.h"
#include "client/view/hand_input.h"
#include "client/view/hand_panel.h"
#include "client/view/hand_view.h"
#include "client/view/view_source.h"

namespace tessera {

/// Hands in a window: the desk with its input and its panels, where the pages' source has a stream to edit
/// by; else nothing happens here.
class WindowHands {
  public:
    /// All outlive this.
    WindowHands(ViewSource& source, const ServerAddress& server, const SceneInfo& scene,
                const std::string& name, const WindowEvents& events);

    bool are_there() const { return desk_ != nullptr; }
    HandDesk* desk() { return desk_.get(); }

    /// Once a frame, within ImGui's and before the camera's input; `last`: the frame before. The cursor is in
    /// pixels of the framebuffer.
    void advance(const ViewFrame& last, Extent extent, double cursor_x, double cursor_y);
    bool has_mouse() const { return desk_ && input_->has_mouse(); }
    bool has_keys() const { return desk_ && input_->has_keys(); }

    void fill(ViewFrame& frame) const {
        if (desk_) desk_->fill(frame);
    }
    using PictureListener =
        std::function<void(std::int32_t pattern, const Rgba8Image& picture, double side_texels)>;
    /// Brings new pictures of patterns to where they are drawn; `brought` is told of each.
    void bring_pictures(PlaneScene& scene, PlaneScene* second, const PictureListener& brought);
    void drawn(const ResidencyFrame& frame) {
        if (desk_) desk_->drawn(frame);
    }
    /// Returns what other panels have to leave free.
    PanelRoom draw_panels(const PlaneView& view, float scale, float pixels_per_unit);

  private:
    /// The same one as long as the view is.
    const HandPicture& picture_of(const PlaneView& view);

    std::unique_ptr<HandDesk> desk_;
    std::unique_ptr<HandInput> input_;
    std::unique_ptr<HandPanel> panel_;
    std::optional<HandPicture> picture_;
    const PlaneScene* known_second_ = nullptr;
};

}  // namespace tessera
