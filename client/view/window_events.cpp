#include "client/view/window_events.h"

#define GLFW_INCLUDE_NONE
#include <algorithm>
#include <cfloat>
#include <iterator>

#include <GLFW/glfw3.h>
#include <imgui.h>

namespace tessera {
namespace {

/// More than anybody does in a frame: then what is told matters less than to catch up.
constexpr std::size_t most_waiting = 256;

bool is_modifier(std::size_t key) { return key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER; }

WindowEvents* of(GLFWwindow* window) { return static_cast<WindowEvents*>(glfwGetWindowUserPointer(window)); }

}  // namespace

struct WindowEvents::Portion {
    std::bitset<key_count> keys;  ///< That changed
    std::bitset<button_count> buttons;
    bool has_move = false;
    bool has_press = false;  ///< Of a button, or of a key that is no modifier
};

void WindowEvents::listen(GLFWwindow* window) {
    glfwSetWindowUserPointer(window, this);
    glfwGetCursorPos(window, &cursor_.x, &cursor_.y);
    glfwSetKeyCallback(window, [](GLFWwindow* on, int key, int, int action, int) {
        if (action != GLFW_REPEAT) of(on)->key(key, action == GLFW_PRESS);
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* on, int button, int action, int) {
        of(on)->button(button, action == GLFW_PRESS);
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow* on, double x, double y) { of(on)->move(x, y); });
}

void WindowEvents::key(int key, bool is_down) {
    if (key < 0 || static_cast<std::size_t>(key) >= key_count) return;
    waiting_.push_back(
        {.kind = Event::Kind::key, .which = static_cast<std::size_t>(key), .is_down = is_down});
}

void WindowEvents::button(int button, bool is_down) {
    if (button < 0 || static_cast<std::size_t>(button) >= button_count) return;
    waiting_.push_back(
        {.kind = Event::Kind::button, .which = static_cast<std::size_t>(button), .is_down = is_down});
}

void WindowEvents::move(double x, double y) {
    if (!waiting_.empty() && waiting_.back().kind == Event::Kind::move)
        waiting_.back().at = {x, y};
    else
        waiting_.push_back({.kind = Event::Kind::move, .at = {x, y}});
}

bool WindowEvents::belongs(const Event& event, const Portion& portion) const {
    switch (event.kind) {
        case Event::Kind::move:
            return portion.buttons.none();  // they changed where the cursor was
        case Event::Kind::button:
            // What is dragged gets there before it is let go
            return !portion.buttons[event.which] && (event.is_down || !portion.has_move);
        case Event::Kind::key:
            return !portion.keys[event.which] && !(portion.has_press && is_modifier(event.which)) &&
                   !(event.is_down && portion.buttons.any());  // keys are answered first
    }
    return true;
}

void WindowEvents::next_frame() {
    Portion portion;
    const bool is_flooded = waiting_.size() > most_waiting;
    while (!waiting_.empty() && (is_flooded || belongs(waiting_.front(), portion))) {
        const Event event = waiting_.front();
        waiting_.pop_front();
        switch (event.kind) {
            case Event::Kind::move:
                portion.has_move = true;
                cursor_ = event.at;
                break;
            case Event::Kind::button:
                portion.buttons.set(event.which);
                portion.has_press |= event.is_down;
                buttons_.set(event.which, event.is_down);
                break;
            case Event::Kind::key:
                portion.keys.set(event.which);
                portion.has_press |= event.is_down && !is_modifier(event.which);
                keys_.set(event.which, event.is_down);
                break;
        }
    }
}

void WindowEvents::tell(ImGuiIO& io) const {
    for (std::size_t key = 0; key < std::min(key_count, std::size(io.KeysDown)); ++key)
        io.KeysDown[key] = keys_[key];
    io.KeyCtrl = is_down(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
    io.KeyShift = is_down(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    io.KeyAlt = is_down(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT);
    io.KeySuper = is_down(GLFW_KEY_LEFT_SUPER, GLFW_KEY_RIGHT_SUPER);
    for (std::size_t button = 0; button < std::min(button_count, std::size(io.MouseDown)); ++button)
        io.MouseDown[button] = buttons_[button];
    if (io.MousePos.x > -FLT_MAX)  // else it has left the window
        io.MousePos = {static_cast<float>(cursor_.x), static_cast<float>(cursor_.y)};
}

}  // namespace tessera
