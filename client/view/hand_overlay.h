#pragma once

#include <span>
#include <vector>

#include <imgui.h>

#include "client/view/hand_desk.h"
#include "client/view/hand_view.h"

namespace tessera {

/// A colour for a map's value: neighbours are far apart.
ImVec4 value_colour(int value);

/// What hands see on the picture: outlines, handles, the brush's ring, targets, and other people's hands.
class HandOverlay {
  public:
    /// `list` and `picture` outlive this. `pixels_per_unit`: of the framebuffer, for one of ImGui's.
    HandOverlay(ImDrawList& list, const HandPicture& picture, float scale, float pixels_per_unit)
        : list_{list}, picture_{picture}, scale_{scale}, unit_{pixels_per_unit} {}

    void selection(const HandDesk& desk);
    /// With the border of its map.
    void brush(HandDesk& desk);
    void targets(HandDesk& desk);
    void people(const HandDesk& desk);

  private:
    std::optional<ImVec2> place(const HandPoint& at, const HandOffset& away = {}) const;
    /// A closed line through points of the plane; nothing if one is behind the eye.
    bool trace(const HandPoint& middle, std::span<const HandOffset> corners);
    void stroke(ImU32 colour, float width, bool dashed = false);
    void border(const TexelBox& box);
    void outline(const HandSprite& sprite, ImU32 colour, float width, bool dashed = false);

    ImDrawList& list_;
    const HandPicture& picture_;
    float scale_, unit_;
    std::vector<ImVec2> line_;
};

}  // namespace tessera
