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
/// They lie on the surface: lines follow hills, and what a hill hides is left out.
class HandOverlay {
  public:
    /// `list` and `picture` outlive this. `pixels_per_unit`: of the framebuffer, for one of ImGui's. `sheet`:
    /// on which all is drawn, of HandPicture::sheets().
    HandOverlay(ImDrawList& list, const HandPicture& picture, float scale, float pixels_per_unit, int sheet)
        : list_{list}, picture_{picture}, scale_{scale}, unit_{pixels_per_unit}, sheet_{sheet} {}

    void selection(const HandDesk& desk);
    /// With the border of its map.
    void brush(HandDesk& desk);
    void targets(HandDesk& desk);
    void people(const HandDesk& desk);

  private:
    std::optional<ImVec2> place(const HandPoint& at, const HandOffset& away = {}) const;
    /// A closed line through points of the texture: what is seen of it, in parts. False: nothing.
    bool trace(const HandPoint& middle, std::span<const HandOffset> corners);
    /// Adds what is seen of an open line; `goes_on`: where the last one ended.
    void follow(const HandPoint& middle, std::span<const HandOffset> way, bool goes_on);
    struct Place {
        HandOffset away;
        std::optional<ImVec2> seen;
    };
    void go_on(const HandPoint& middle, const Place& from, const Place& to, int halvings);
    void begin_line(const ImVec2& at);
    /// Of what was traced.
    void stroke(ImU32 colour, float width, bool dashed = false);
    /// Of what was traced, on a plane: it is convex there.
    void fill(ImU32 colour);
    /// From `way` pixels along a line on; how far that is at its end.
    float dashes(const ImVec2& a, const ImVec2& b, float way, ImU32 colour, float width);
    void border(const TexelBox& box);
    void outline(const HandSprite& sprite, ImU32 colour, float width, bool dashed = false);

    ImDrawList& list_;
    const HandPicture& picture_;
    float scale_, unit_;
    int sheet_;
    struct Line {
        std::vector<ImVec2> points;
        bool is_closed = false;
        bool is_open = false;  ///< Its last point is the last that was looked at.
    };
    std::vector<Line> lines_;  ///< What was traced last
};

}  // namespace tessera
