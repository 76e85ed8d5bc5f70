#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <deque>

struct GLFWwindow;
struct ImGuiIO;

namespace tessera {

/// What mouse and keys did, told in such portions, a frame at a time, that nothing is lost however slow
/// frames are: a tap shorter than a frame is down for one, a press is where the cursor was, and a key counts
/// with the modifiers it was struck with. Keys and buttons are GLFW's.
class WindowEvents {
  public:
    WindowEvents() = default;
    WindowEvents(const WindowEvents&) = delete;
    WindowEvents& operator=(const WindowEvents&) = delete;

    /// Hears of the window's events from now on, as long as both live. ImGui's back end comes after this.
    void listen(GLFWwindow* window);

    // ---- As they happen
    void key(int key, bool is_down);
    void button(int button, bool is_down);
    void move(double x, double y);

    /// Once a frame: what happened since, up to where one frame could not tell it right.
    void next_frame();

    // ---- In this frame
    bool is_down(int key) const { return in(keys_, key); }
    bool is_down(int key, int other) const { return is_down(key) || is_down(other); }
    bool is_button_down(int button) const { return in(buttons_, button); }
    struct Place {
        double x = 0, y = 0;  ///< In the window's own units, from its top-left corner
    };
    const Place& cursor() const { return cursor_; }
    /// The same for ImGui, after its back end and before its frame.
    void tell(ImGuiIO& io) const;

  private:
    static constexpr std::size_t key_count = 512, button_count = 8;
    struct Event {
        enum class Kind { key, button, move } kind;
        std::size_t which = 0;
        bool is_down = false;
        Place at{};
    };
    template <std::size_t count>
    static bool in(const std::bitset<count>& set, int which) {
        return which >= 0 && static_cast<std::size_t>(which) < count && set[static_cast<std::size_t>(which)];
    }
    struct Portion;  ///< What a frame has been told so far
    bool belongs(const Event& event, const Portion& portion) const;

    std::deque<Event> waiting_;
    std::bitset<key_count> keys_;
    std::bitset<button_count> buttons_;
    Place cursor_;
};

}  // namespace tessera
