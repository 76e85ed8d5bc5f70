#pragma once

#include <map>

#include "client/render/gl_objects.h"
#include "client/view/hand_desk.h"
#include "client/view/hand_view.h"
#include "client/view/panels/panel_columns.h"

namespace tessera {

/// The editor's part of the window: the palette and the tools in a bar, the selection's properties, what is
/// selected with its handles on the picture, other people's hands, and their last edits. Needs ImGui and GL.
class HandPanel {
  public:
    /// `desk` outlives this.
    explicit HandPanel(HandDesk& desk) : desk_{desk} {}

    /// Once a frame, within ImGui's. `pixels_per_unit`: of the framebuffer, for one of ImGui's. Returns what
    /// other panels have to leave free.
    PanelRoom draw(const HandPicture& picture, float scale, float pixels_per_unit);

  private:
    void tool_bar(float scale);
    void palette(float scale);
    void brush_tools(float scale);
    void target_tools();
    void selection_bar(float scale);
    void others_news(float scale, float from_below);
    struct Bar {
        float left = 0, right = 0, height = 0, from_below = 0;  ///< In ImGui's units
        bool is_above = true;                                   ///< At the window's top, or not there
    };
    void bars(float scale);
    static Bar bar_here(float from_below);
    void words(const ImVec4& colour, const std::string& text, float scale);
    void on_picture(const HandPicture& picture, float scale, float pixels_per_unit);
    GLuint texture_of(std::int32_t pattern);

    HandDesk& desk_;
    struct Picture {
        GlTexture texture;
        const Rgba8Image* made_of = nullptr;
    };
    std::map<std::int32_t, Picture> pictures_;
    Bar tools_, selection_;
    float news_height_ = 0;
    float selection_width_ = 600;  ///< As it was last drawn
};

}  // namespace tessera
