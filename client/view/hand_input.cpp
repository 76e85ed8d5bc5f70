#include "client/view/hand_input.h"

#define GLFW_INCLUDE_NONE
#include <algorithm>
#include <cmath>

#include <GLFW/glfw3.h>
#include <imgui.h>

#include "client/view/panels/panel_columns.h"

namespace tessera {
namespace {

constexpr double slack_pixels = 4;  ///< Farther than this, and it is a drag
constexpr double nudge_far = 10, right_turns = 1.0 / 24;

bool pressed(int key, bool repeats = false) { return ImGui::IsKeyPressed(key, repeats); }

}  // namespace

std::string why_not_paint(HandDesk& desk) {
    const MapBrush* brush = desk.brush();
    if (desk.tool != HandDesk::Tool::brush || !brush || !desk.cursor()) return {};
    const auto border = brush->border();
    if (!border || !brush->entries_at(*desk.cursor()).empty()) return {};
    return "Outside of " + brush->grid().block() + ", which reaches from " + grouped(border->x0) + ", " +
           grouped(border->y0) + " to " + grouped(border->x1) + ", " + grouped(border->y1);
}

void HandInput::advance(const HandPicture& view, double cursor_x, double cursor_y, Extent extent, int level) {
    took_escape_ = false;
    const ImGuiIO& io = ImGui::GetIO();
    const bool on_picture = !io.WantCaptureMouse;
    const auto at = view.point_at(cursor_x, cursor_y, extent);
    desk_.be_at(on_picture ? at : std::nullopt, level);
    if (!io.WantTextInput) keys(view.texels_per_pixel(cursor_x, cursor_y));
    Hand& hand = desk_.hand();
    if (is_down_ && (!desk_.is_open || desk_.tool != tool_)) let_go();
    const bool button = events_.is_button_down(GLFW_MOUSE_BUTTON_LEFT);
    if (!desk_.is_open) {
        was_button_ = button;
        hand.hover(std::nullopt);
        return;
    }
    const bool snap = events_.is_down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    if (at) last_ = at;
    if (!is_down_) {
        hand.hover(on_picture && desk_.tool == HandDesk::Tool::hand ? at : std::nullopt);
        const bool is_new = button && !was_button_;
        was_button_ = button;
        if (!is_new || !on_picture || !at || events_.is_down(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL))
            return;
        is_down_ = true;
        moved_ = false;
        tool_ = desk_.tool;
        start_x_ = cursor_x;
        start_y_ = cursor_y;
        press(*at, view.texels_per_pixel(cursor_x, cursor_y));
        return;
    }
    was_button_ = button;
    if (std::hypot(cursor_x - start_x_, cursor_y - start_y_) > slack_pixels) moved_ = true;
    if (last_) drag(button, snap);
    if (!button) is_down_ = has_mouse_ = false;
}

void HandInput::drag(bool is_down, bool snap) {
    switch (tool_) {
        case HandDesk::Tool::hand:
            if (is_down)
                desk_.hand().drag(*last_, moved_, snap);
            else
                desk_.hand().release(*last_, moved_);
            break;
        case HandDesk::Tool::brush:
            if (MapBrush* brush = desk_.brush()) {
                if (is_down && has_mouse_) brush->drag(*last_);
                if (!is_down) brush->release();
            }
            break;
        case HandDesk::Tool::target:
            if (is_down)
                desk_.targets().drag(*last_);
            else
                desk_.targets().release();
            break;
    }
}

/// The tool is another, or the editor is closed, while the button is down: what was done stays done.
void HandInput::let_go() {
    if (tool_ == HandDesk::Tool::hand) desk_.hand().cancel();
    for (MapBrush& brush : desk_.brushes()) brush.release();
    desk_.targets().release();
    is_down_ = has_mouse_ = false;
}

void HandInput::press(const HandPoint& at, double texels_per_pixel) {
    const bool add = events_.is_down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    switch (desk_.tool) {
        case HandDesk::Tool::hand:
            has_mouse_ = desk_.hand().press(at, add);
            break;
        case HandDesk::Tool::brush:
            has_mouse_ = desk_.brush() != nullptr;
            if (MapBrush* brush = desk_.brush()) brush->press(at);
            desk_.say(why_not_paint(desk_));
            break;
        case HandDesk::Tool::target:
            if (const auto target = desk_.targets().at(at, 14 * texels_per_pixel)) {
                desk_.targets().press(*target, at);
                has_mouse_ = true;
            }
            break;
    }
}

bool HandInput::escape() {
    Hand& hand = desk_.hand();
    if (hand.cancel()) {
        has_mouse_ = false;
        return true;
    }
    if (hand.placing())
        hand.choose(std::nullopt);
    else if (!hand.selected().empty())
        hand.select({});
    else if (desk_.tool != HandDesk::Tool::hand)
        desk_.tool = HandDesk::Tool::hand;
    else
        desk_.is_open = false;
    return true;
}

void HandInput::keys(double texels_per_pixel) {
    const bool control = events_.is_down(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
    const bool shift = events_.is_down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    if (!control && (pressed(GLFW_KEY_ENTER) || pressed(GLFW_KEY_KP_ENTER)) && desk_.takes_edits()) {
        desk_.is_open = !desk_.is_open;
        if (!desk_.is_open) {
            desk_.hand().cancel();
            desk_.hand().select({});
        }
    }
    if (!desk_.is_open) return;
    Hand& hand = desk_.hand();
    if (control) {
        if (pressed(GLFW_KEY_Z, true)) shift ? desk_.redo() : desk_.undo();
        if (pressed(GLFW_KEY_Y, true)) desk_.redo();
        if (pressed(GLFW_KEY_D)) hand.duplicate();
        if (pressed(GLFW_KEY_A)) hand.select_all();
        return;
    }
    if (pressed(GLFW_KEY_ESCAPE)) took_escape_ = escape();
    if (pressed(GLFW_KEY_V)) {
        desk_.tool = HandDesk::Tool::hand;
        hand.choose(std::nullopt);
    }
    if (desk_.tool == HandDesk::Tool::hand) sprite_keys(texels_per_pixel);
    if (MapBrush* brush = desk_.brush(); brush && desk_.tool == HandDesk::Tool::brush) {
        if (pressed(GLFW_KEY_LEFT_BRACKET, true)) brush->radius_texels /= 1.25;
        if (pressed(GLFW_KEY_RIGHT_BRACKET, true)) brush->radius_texels *= 1.25;
        const double entry = static_cast<double>(brush->grid().entry_texels());
        brush->radius_texels = std::clamp(brush->radius_texels, entry / 2, 60 * entry);
    }
}

void HandInput::sprite_keys(double texels_per_pixel) {
    Hand& hand = desk_.hand();
    for (int i = 0; i < std::min(9, desk_.pattern_count()); ++i)
        if (pressed(GLFW_KEY_1 + i)) hand.choose(i);
    if (hand.selected().empty()) return;
    const bool shift = events_.is_down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    if (pressed(GLFW_KEY_DELETE) || pressed(GLFW_KEY_BACKSPACE)) hand.remove();
    if (pressed(GLFW_KEY_PAGE_UP)) hand.raise(true);
    if (pressed(GLFW_KEY_PAGE_DOWN)) hand.raise(false);
    if (pressed(GLFW_KEY_R, true)) hand.change_together({.turns = shift ? -right_turns : right_turns});
    const auto step = static_cast<std::int64_t>(sprite_units * (shift ? nudge_far : 1) *
                                                std::max(1.0, std::floor(texels_per_pixel + 0.5)));
    const auto nudge = [&](int key, std::int64_t x, std::int64_t y) {
        if (pressed(key, true)) hand.change_together({.dx = x * step, .dy = y * step});
    };
    nudge(GLFW_KEY_LEFT, -1, 0);
    nudge(GLFW_KEY_RIGHT, 1, 0);
    nudge(GLFW_KEY_UP, 0, -1);
    nudge(GLFW_KEY_DOWN, 0, 1);
}

}  // namespace tessera
