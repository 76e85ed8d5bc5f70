#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>
#include <xcb/xcb.h>

namespace tessera::test {

/// A screen of its own (Xvfb), and hands on its mouse and keyboard: events go the way of a person's, by the
/// XTEST extension. DISPLAY names it for programs that are started later. One at a time.
class XScreen {
  public:
    /// `dots_per_inch`: what the desktop's settings say; 96 is what text is made for.
    explicit XScreen(int width, int height, int dots_per_inch = 96);
    ~XScreen();
    XScreen(const XScreen&) = delete;
    XScreen& operator=(const XScreen&) = delete;

    // ---- Hands
    void move(double x, double y) { fake(motion, 0, x, y); }
    void press(int button = 1) { fake(button_press, button); }
    void release(int button = 1) { fake(button_release, button); }
    /// As quick as hands cannot be: all of it may fall between two frames.
    void click(double x, double y, int button = 1);
    void drag(double x0, double y0, double x1, double y1, int button = 1);
    /// By X's names for keys: 'a', XK_Return; with `with` held meanwhile.
    void tap(xcb_keysym_t key, const std::vector<xcb_keysym_t>& with = {});
    void hold(xcb_keysym_t key) { fake(key_press, code_of(key)); }
    void let_go(xcb_keysym_t key) { fake(key_release, code_of(key)); }

    // ---- The window whose title has a word in it
    bool wait_for_window(const std::string& word);
    std::string title() const;
    void resize(int width, int height);
    void hide();
    void show();
    struct Size {
        int width = 0, height = 0;
        bool operator==(const Size&) const = default;
    };
    Size window_size() const;

    // ---- What is seen
    struct Picture {
        int width = 0, height = 0;
        std::vector<std::uint8_t> bytes;  ///< Four a pixel: blue, green, red, nothing
        /// 0xRRGGBB
        std::uint32_t at(int x, int y) const;
    };
    /// Of the window's part of the screen.
    Picture picture() const;

  private:
    enum Kind : std::uint8_t { key_press = 2, key_release, button_press, button_release, motion };
    void fake(Kind kind, int detail, double x = 0, double y = 0);
    int code_of(xcb_keysym_t key) const;
    void configure(std::uint16_t mask, const std::uint32_t* values);

    pid_t server_ = -1;
    xcb_connection_t* connection_ = nullptr;
    xcb_screen_t* screen_ = nullptr;
    xcb_window_t window_ = 0;
    int keys_a_code_ = 0, first_code_ = 0;
    std::vector<xcb_keysym_t> symbols_;
};

}  // namespace tessera::test
