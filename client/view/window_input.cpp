#include "client/view/window_input.h"

#define GLFW_INCLUDE_NONE
#include <algorithm>
#include <cmath>

#include <GLFW/glfw3.h>
#include <imgui.h>

namespace tessera {
namespace {

constexpr double orbit_degrees_per_pixel = 0.25;
constexpr double zoom_steps_per_second = 7;  ///< While + or − is held

}  // namespace

WindowInput::WindowInput(GlfwWindow& window, const WindowEvents& events, CameraControl& control,
                         const Camera& home)
    : window_{window}, events_{events}, control_{control}, home_{home} {}

WindowInput::Pixels WindowInput::cursor_pixels() const {
    const auto [x, y] = events_.cursor();
    int width = 1, height = 1;
    glfwGetWindowSize(window_.handle(), &width, &height);
    const GlfwWindow::Size pixels = window_.framebuffer_size();
    return {x * pixels.width / std::max(width, 1), y * pixels.height / std::max(height, 1)};
}

void WindowInput::advance(double seconds, ViewerSwitches& switches) {
    mouse(switches);
    const bool typing = ImGui::GetIO().WantTextInput;
    if (!typing) keys(switches);
    if (!typing && (is_down(GLFW_KEY_EQUAL) || is_down(GLFW_KEY_KP_ADD) || is_down(GLFW_KEY_MINUS) ||
                    is_down(GLFW_KEY_KP_SUBTRACT))) {
        const bool nearer = is_down(GLFW_KEY_EQUAL) || is_down(GLFW_KEY_KP_ADD);
        const GlfwWindow::Size size = window_.framebuffer_size();
        control_.zoom_at(size.width, size.height, last_cursor_.x, last_cursor_.y,
                         (nearer ? 1 : -1) * zoom_steps_per_second * seconds);
    }
    const CameraControl::Steering held = typing ? CameraControl::Steering{} : steering();
    is_steering_ = held.forwards != 0 || held.sideways != 0 || held.upwards != 0;
    control_.advance(seconds, held);
}

bool WindowInput::is_on_split(const ViewerSwitches& switches, const Pixels& cursor) const {
    if (!switches.split) return false;
    const double reach = 6 * static_cast<double>(window_.content_scale());
    return std::abs(cursor.x - switches.split->at * window_.framebuffer_size().width) < reach;
}

void WindowInput::mouse(ViewerSwitches& switches) {
    const ImGuiIO& io = ImGui::GetIO();
    const GlfwWindow::Size size = window_.framebuffer_size();
    const Pixels cursor = cursor_pixels(), last = last_cursor_;
    last_cursor_ = cursor;
    if (!io.WantCaptureMouse && io.MouseWheel != 0)
        control_.zoom_at(size.width, size.height, cursor.x, cursor.y, static_cast<double>(io.MouseWheel));

    if (dragging_ >= 0 && !events_.is_button_down(dragging_)) dragging_ = -1;
    for (const int button : {GLFW_MOUSE_BUTTON_LEFT, GLFW_MOUSE_BUTTON_RIGHT, GLFW_MOUSE_BUTTON_MIDDLE}) {
        if (dragging_ >= 0 || io.WantCaptureMouse) break;
        if (button == GLFW_MOUSE_BUTTON_LEFT && no_left_button_) continue;
        if (events_.is_button_down(button)) {
            dragging_ = button;
            drags_split_ = button == GLFW_MOUSE_BUTTON_LEFT && is_on_split(switches, cursor);
            return;
        }
    }
    if (!io.WantCaptureMouse && ((dragging_ >= 0 && drags_split_) || is_on_split(switches, cursor)))
        ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (dragging_ < 0 || (cursor.x == last.x && cursor.y == last.y)) return;
    if (drags_split_) {
        if (switches.split) switches.split->at = std::clamp(cursor.x / size.width, 0.02, 0.98);
        return;
    }
    const double across = cursor.x - last.x, down = cursor.y - last.y;
    const bool orbiting =
        dragging_ == GLFW_MOUSE_BUTTON_MIDDLE ||
        (dragging_ == GLFW_MOUSE_BUTTON_LEFT && is_down(GLFW_KEY_LEFT_CONTROL) != switches.orbits);
    if (orbiting) {
        control_.orbit(across * orbit_degrees_per_pixel, -down * orbit_degrees_per_pixel);
    } else if (dragging_ == GLFW_MOUSE_BUTTON_LEFT) {
        control_.drag_plane(size.width, size.height, last.x, last.y, cursor.x, cursor.y);
    } else {
        const double degrees = control_.camera().field_of_view_degrees / size.height;
        control_.look(-across * degrees, down * degrees);
    }
}

CameraControl::Steering WindowInput::steering() const {
    if (no_editing_keys_) {  // letters alone: arrows move what is selected
        if (is_down(GLFW_KEY_LEFT_CONTROL) || is_down(GLFW_KEY_RIGHT_CONTROL)) return {};
        const auto between = [&](int positive, int negative) {
            return (is_down(positive) ? 1.0 : 0.0) - (is_down(negative) ? 1.0 : 0.0);
        };
        return {between(GLFW_KEY_W, GLFW_KEY_S), between(GLFW_KEY_D, GLFW_KEY_A),
                between(GLFW_KEY_E, GLFW_KEY_Q),
                is_down(GLFW_KEY_LEFT_SHIFT) || is_down(GLFW_KEY_RIGHT_SHIFT)};
    }
    const auto axis = [&](int positive, int other_positive, int negative, int other_negative) {
        return (is_down(positive) || is_down(other_positive) ? 1.0 : 0.0) -
               (is_down(negative) || is_down(other_negative) ? 1.0 : 0.0);
    };
    return {axis(GLFW_KEY_W, GLFW_KEY_UP, GLFW_KEY_S, GLFW_KEY_DOWN),
            axis(GLFW_KEY_D, GLFW_KEY_RIGHT, GLFW_KEY_A, GLFW_KEY_LEFT),
            axis(GLFW_KEY_E, GLFW_KEY_PAGE_UP, GLFW_KEY_Q, GLFW_KEY_PAGE_DOWN),
            is_down(GLFW_KEY_LEFT_SHIFT) || is_down(GLFW_KEY_RIGHT_SHIFT)};
}

void WindowInput::keys(ViewerSwitches& switches) {
    // ImGui's GLFW back end of this version fills KeysDown by GLFW's key numbers
    const bool editing = no_editing_keys_;
    if (editing && (is_down(GLFW_KEY_LEFT_CONTROL) || is_down(GLFW_KEY_RIGHT_CONTROL))) return;
    const auto pressed = [&](int key) {
        const bool is_editors =
            (key >= GLFW_KEY_1 && key <= GLFW_KEY_9) || key == GLFW_KEY_V || key == GLFW_KEY_R;
        return ImGui::IsKeyPressed(key, false) && !(editing && is_editors);
    };
    if (pressed(GLFW_KEY_H) || pressed(GLFW_KEY_F1)) switches.help = !switches.help;
    if (pressed(GLFW_KEY_TAB)) switches.panel = !switches.panel;
    if (pressed(GLFW_KEY_M)) switches.metrics = !switches.metrics;
    if (pressed(GLFW_KEY_B))
        switches.overlay = overlays[(static_cast<std::size_t>(switches.overlay) + 1) % overlays.size()];
    if (pressed(GLFW_KEY_F)) {
        const bool back = is_down(GLFW_KEY_LEFT_SHIFT) || is_down(GLFW_KEY_RIGHT_SHIFT);
        switches.filter.filter = filter_after(switches.filter.filter, back ? -1 : 1, has_driver_anisotropy());
    }
    for (std::size_t i = 0; i < filters.size(); ++i)
        if (pressed(GLFW_KEY_1 + static_cast<int>(i)) &&
            (filters[i] != Filter::driver_anisotropic || has_driver_anisotropy()))
            switches.filter.filter = filters[i];
    const bool shift = is_down(GLFW_KEY_LEFT_SHIFT) || is_down(GLFW_KEY_RIGHT_SHIFT);
    if (pressed(GLFW_KEY_V))
        switches.surface = surface_after(switches.surface, shift ? -1 : 1, control_.camera());
    if (pressed(GLFW_KEY_O)) switches.orbits = !switches.orbits;
    if (pressed(GLFW_KEY_X)) switch_split(switches);
    if (pressed(GLFW_KEY_R)) requests_.record = true;
    if (pressed(GLFW_KEY_L)) requests_.play = true;
    if (pressed(GLFW_KEY_T)) control_.look_straight_down();
    if (pressed(GLFW_KEY_HOME)) control_.set(home_);
    if (pressed(GLFW_KEY_K)) requests_.camera_key = true;
    if (pressed(GLFW_KEY_P))
        (is_down(GLFW_KEY_LEFT_SHIFT) ? requests_.screenshot_with_panels : requests_.screenshot) = true;
    if (pressed(GLFW_KEY_F11)) toggle_full_screen();
    if (pressed(GLFW_KEY_ESCAPE)) {
        if (switches.help)
            switches.help = false;
        else if (!editing)
            glfwSetWindowShouldClose(window_.handle(), GLFW_TRUE);
    }
}

void WindowInput::toggle_full_screen() {
    GLFWwindow* window = window_.handle();
    if (glfwGetWindowMonitor(window)) {
        glfwSetWindowMonitor(window, nullptr, window_place_[0], window_place_[1], window_place_[2],
                             window_place_[3], GLFW_DONT_CARE);
        return;
    }
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
    if (!mode) return;
    glfwGetWindowPos(window, &window_place_[0], &window_place_[1]);
    glfwGetWindowSize(window, &window_place_[2], &window_place_[3]);
    glfwSetWindowMonitor(window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

}  // namespace tessera
