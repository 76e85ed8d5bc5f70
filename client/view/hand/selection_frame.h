#pragma once

#include <array>
#include <optional>
#include <span>

#include "client/view/hand/hand_sprite.h"

namespace tessera {

/// What a selection is scaled and turned by: four corners around it and a knob above, on the plane.
struct SelectionFrame {
    HandPoint middle{};
    std::array<HandOffset, 4> corners{};  ///< Texels from the middle, clockwise
    HandOffset knob{};

    /// Around sprites that rest; one sprite's own corners, or a box around several. Those of what is tiny
    /// stand apart, so that the sprites themselves can be taken hold of. Nothing for no sprites.
    static std::optional<SelectionFrame> around(std::span<const HandSprite> sprites, double texels_per_pixel);
};

/// A corner (0 to 3) or the knob (4).
struct FrameHandle {
    int which = 0;
    bool turns() const { return which == 4; }
};

/// The handle near a point, within what a finger's width is on the plane.
std::optional<FrameHandle> handle_at(const SelectionFrame& frame, const HandPoint& at,
                                     double texels_per_pixel);

}  // namespace tessera
