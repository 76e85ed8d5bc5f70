#pragma once

#include <map>

#include "client/render/gl_objects.h"
#include "client/view/hand_desk.h"
#include "client/view/hand_view.h"

namespace tessera {

/// The editor's part of the window: the palette and the tools in a bar, the selection's properties, what is
/// selected with its handles on the picture, other people's hands, and their last edits. Needs ImGui and GL.
class HandPanel {
  public:
    /// `desk` outlives this.
    explicit HandPanel(HandDesk& desk) : desk_{desk} {}

    /// Once a frame, within ImGui's. `pixels_per_unit`: of the framebuffer, for one of ImGui's.
    void draw(const HandPicture& picture, float scale, float pixels_per_unit);

  private:
    void tool_bar(float scale);
    void palette(float scale);
    void brush_tools(float scale);
    void target_tools();
    void selection_bar(float scale);
    void others_news(float scale);
    void on_picture(const HandPicture& picture, float scale, float pixels_per_unit);
    GLuint texture_of(std::int32_t pattern);

    HandDesk& desk_;
    struct Picture {
        GlTexture texture;
        const Rgba8Image* made_of = nullptr;
    };
    std::map<std::int32_t, Picture> pictures_;
    double scale_ = 1, turn_ = 0;
    int was_selected_ = 0;
};

}  // namespace tessera
