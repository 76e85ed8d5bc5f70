#include "client/view/hand/selection_frame.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr double least_reach_pixels = 24, corner_gap_pixels = 3, knob_pixels = 26, hold_pixels = 13;

HandOffset lengthened(const HandOffset& offset, double by, double least) {
    const double length = std::max(std::hypot(offset.x, offset.y), 1e-9);
    const double factor = std::max(length + by, least) / length;
    return {offset.x * factor, offset.y * factor};
}

}  // namespace

std::optional<SelectionFrame> SelectionFrame::around(std::span<const HandSprite> sprites,
                                                     double texels_per_pixel) {
    if (sprites.empty()) return std::nullopt;
    SelectionFrame frame;
    if (sprites.size() == 1) {
        frame.middle = {sprites.front().x, sprites.front().y};
        frame.corners = corners_of(sprites.front());
    } else {
        const TexelBox box = box_around(sprites, 0);
        frame.middle = {(box.x0 + box.x1) * sprite_units / 2, (box.y0 + box.y1) * sprite_units / 2};
        const double x = static_cast<double>(box.x1 - box.x0) / 2,
                     y = static_cast<double>(box.y1 - box.y0) / 2;
        frame.corners = {{{-x, -y}, {x, -y}, {x, y}, {-x, y}}};
    }
    for (HandOffset& corner : frame.corners)
        corner =
            lengthened(corner, corner_gap_pixels * texels_per_pixel, least_reach_pixels * texels_per_pixel);
    const HandOffset top{(frame.corners[0].x + frame.corners[1].x) / 2,
                         (frame.corners[0].y + frame.corners[1].y) / 2};
    frame.knob = lengthened(top, knob_pixels * texels_per_pixel, 0);
    return frame;
}

std::optional<FrameHandle> handle_at(const SelectionFrame& frame, const HandPoint& at,
                                     double texels_per_pixel) {
    const double x = static_cast<double>(at.x - frame.middle.x) / sprite_units,
                 y = static_cast<double>(at.y - frame.middle.y) / sprite_units;
    const auto is_near = [&](const HandOffset& handle) {
        return std::hypot(handle.x - x, handle.y - y) <= hold_pixels * texels_per_pixel;
    };
    if (is_near(frame.knob)) return FrameHandle{4};
    for (int corner = 0; corner < 4; ++corner)
        if (is_near(frame.corners[static_cast<std::size_t>(corner)])) return FrameHandle{corner};
    return std::nullopt;
}

}  // namespace tessera
