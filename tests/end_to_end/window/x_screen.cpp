#include "tests/end_to_end/window/x_screen.h"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <xcb/xcbext.h>

extern char** environ;

namespace tessera::test {
namespace {

/// The XTEST extension's FakeInput, as its protocol (X.Org, "XTEST Extension Protocol", 2.2) lays it out.
struct FakeInput {
    std::uint8_t major_opcode, minor_opcode;
    std::uint16_t length;
    std::uint8_t type, detail;
    std::uint16_t unused;
    std::uint32_t delay_ms;
    xcb_window_t root;
    std::uint32_t unused2[2];
    std::int16_t x, y;
    std::uint8_t unused3[7];
    std::uint8_t device;
};
static_assert(sizeof(FakeInput) == 36);

xcb_extension_t xtest{"XTEST", 0};

template <class T>
struct Freed {
    void operator()(T* reply) const { std::free(reply); }
};
template <class T>
std::unique_ptr<T, Freed<T>> own(T* reply) {
    return std::unique_ptr<T, Freed<T>>{reply};
}

/// Waits for the number of the display that the server has chosen.
std::string first_line(int file) {
    std::string line;
    for (char one; ::read(file, &one, 1) == 1 && one != '\n';) line += one;
    return line;
}

}  // namespace

XScreen::XScreen(int width, int height, int dots_per_inch) {
    int numbers[2];
    if (pipe2(numbers, O_CLOEXEC) != 0) throw std::runtime_error{"no pipe"};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, numbers[1], 3);
    std::string words[] = {XVFB,        "-displayfd",
                           "3",         "-screen",
                           "0",         std::to_string(width) + "x" + std::to_string(height) + "x24",
                           "-nolisten", "tcp"};
    std::vector<char*> command;
    for (std::string& word : words) command.push_back(word.data());
    command.push_back(nullptr);
    const int failed = posix_spawn(&server_, XVFB, &actions, nullptr, command.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(numbers[1]);
    const std::string number = failed == 0 ? first_line(numbers[0]) : std::string{};
    ::close(numbers[0]);
    if (number.empty()) throw std::runtime_error{"Xvfb does not start"};
    const std::string name = ":" + number;
    ::setenv("DISPLAY", name.c_str(), 1);

    connection_ = xcb_connect(name.c_str(), nullptr);
    if (xcb_connection_has_error(connection_) != 0) throw std::runtime_error{"no connection to " + name};
    const xcb_setup_t* setup = xcb_get_setup(connection_);
    screen_ = xcb_setup_roots_iterator(setup).data;
    const xcb_query_extension_reply_t* extension = xcb_get_extension_data(connection_, &xtest);
    if (!extension || extension->present == 0) throw std::runtime_error{"Xvfb has no XTEST"};
    first_code_ = setup->min_keycode;
    const auto mapping = own(xcb_get_keyboard_mapping_reply(
        connection_,
        xcb_get_keyboard_mapping(connection_, setup->min_keycode,
                                 static_cast<std::uint8_t>(setup->max_keycode - setup->min_keycode + 1)),
        nullptr));
    if (!mapping) throw std::runtime_error{"no keyboard"};
    keys_a_code_ = mapping->keysyms_per_keycode;
    const xcb_keysym_t* symbols = xcb_get_keyboard_mapping_keysyms(mapping.get());
    symbols_.assign(symbols, symbols + xcb_get_keyboard_mapping_keysyms_length(mapping.get()));
    const std::string settings = "Xft.dpi:\t" + std::to_string(dots_per_inch) + "\n";
    xcb_change_property(connection_, XCB_PROP_MODE_REPLACE, screen_->root, XCB_ATOM_RESOURCE_MANAGER,
                        XCB_ATOM_STRING, 8, static_cast<std::uint32_t>(settings.size()), settings.data());
    xcb_flush(connection_);
}

XScreen::~XScreen() {
    if (connection_) xcb_disconnect(connection_);
    if (server_ > 0) {
        ::kill(server_, SIGTERM);
        ::waitpid(server_, nullptr, 0);
    }
    ::unsetenv("DISPLAY");
}

// ---- Hands

void XScreen::fake(Kind kind, int detail, double x, double y) {
    FakeInput input{};
    input.minor_opcode = 2;
    input.type = kind;
    input.detail = static_cast<std::uint8_t>(detail);
    if (kind == motion) {
        input.root = screen_->root;
        input.x = static_cast<std::int16_t>(std::lround(x));
        input.y = static_cast<std::int16_t>(std::lround(y));
    }
    // libxcb writes its own two parts before these
    iovec parts[4]{};
    parts[2] = {&input, sizeof input};
    parts[3] = {nullptr, 0};
    const xcb_protocol_request_t request{.count = 2, .ext = &xtest, .opcode = 2, .isvoid = 1};
    xcb_send_request(connection_, 0, parts + 2, &request);
    xcb_flush(connection_);
}

int XScreen::code_of(xcb_keysym_t key) const {
    for (std::size_t i = 0; i < symbols_.size(); ++i)
        if (symbols_[i] == key) return first_code_ + static_cast<int>(i) / keys_a_code_;
    throw std::runtime_error{"the keyboard has no key " + std::to_string(key)};
}

void XScreen::click(double x, double y, int button) {
    move(x, y);
    press(button);
    release(button);
}

void XScreen::drag(double x0, double y0, double x1, double y1, int button) {
    move(x0, y0);
    press(button);
    constexpr int steps = 6;
    for (int i = 1; i <= steps; ++i) move(x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps);
    release(button);
}

void XScreen::tap(xcb_keysym_t key, const std::vector<xcb_keysym_t>& with) {
    for (const xcb_keysym_t held : with) hold(held);
    hold(key);
    let_go(key);
    for (const xcb_keysym_t held : with) let_go(held);
}

// ---- The window

bool XScreen::wait_for_window(const std::string& word) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds{60};
    while (std::chrono::steady_clock::now() < until) {
        const auto tree =
            own(xcb_query_tree_reply(connection_, xcb_query_tree(connection_, screen_->root), nullptr));
        const int count = tree ? xcb_query_tree_children_length(tree.get()) : 0;
        for (int i = 0; i < count; ++i) {
            window_ = xcb_query_tree_children(tree.get())[i];
            const auto attributes = own(xcb_get_window_attributes_reply(
                connection_, xcb_get_window_attributes(connection_, window_), nullptr));
            if (!attributes || attributes->map_state != XCB_MAP_STATE_VIEWABLE ||
                title().find(word) == std::string::npos)
                continue;
            const std::uint32_t corner[] = {0, 0};
            configure(XCB_CONFIG_WINDOW_X | XCB_CONFIG_WINDOW_Y, corner);
            xcb_set_input_focus(connection_, XCB_INPUT_FOCUS_POINTER_ROOT, window_, XCB_CURRENT_TIME);
            xcb_flush(connection_);
            return true;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds{50});
    }
    return false;
}

std::string XScreen::title() const {
    const auto name = own(xcb_get_property_reply(
        connection_,
        xcb_get_property(connection_, 0, window_, XCB_ATOM_WM_NAME, XCB_GET_PROPERTY_TYPE_ANY, 0, 100),
        nullptr));
    if (!name) return {};
    return {static_cast<const char*>(xcb_get_property_value(name.get())),
            static_cast<std::size_t>(xcb_get_property_value_length(name.get()))};
}

void XScreen::configure(std::uint16_t mask, const std::uint32_t* values) {
    xcb_configure_window(connection_, window_, mask, values);
    xcb_flush(connection_);
}

void XScreen::resize(int width, int height) {
    const std::uint32_t size[] = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
    configure(XCB_CONFIG_WINDOW_WIDTH | XCB_CONFIG_WINDOW_HEIGHT, size);
}

void XScreen::hide() {
    xcb_unmap_window(connection_, window_);
    xcb_flush(connection_);
}

void XScreen::show() {
    xcb_map_window(connection_, window_);
    xcb_flush(connection_);
    std::this_thread::sleep_for(std::chrono::milliseconds{200});
    xcb_set_input_focus(connection_, XCB_INPUT_FOCUS_POINTER_ROOT, window_, XCB_CURRENT_TIME);
    xcb_flush(connection_);
}

XScreen::Size XScreen::window_size() const {
    const auto geometry =
        own(xcb_get_geometry_reply(connection_, xcb_get_geometry(connection_, window_), nullptr));
    return geometry ? Size{geometry->width, geometry->height} : Size{};
}

// ---- What is seen

std::uint32_t XScreen::Picture::at(int x, int y) const {
    const std::uint8_t* pixel =
        bytes.data() +
        4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    return std::uint32_t{pixel[2]} << 16 | std::uint32_t{pixel[1]} << 8 | pixel[0];
}

XScreen::Picture XScreen::picture() const {
    const Size size = window_size();
    const auto image = own(xcb_get_image_reply(
        connection_,
        xcb_get_image(connection_, XCB_IMAGE_FORMAT_Z_PIXMAP, screen_->root, 0, 0,
                      static_cast<std::uint16_t>(std::min<int>(size.width, screen_->width_in_pixels)),
                      static_cast<std::uint16_t>(std::min<int>(size.height, screen_->height_in_pixels)), ~0U),
        nullptr));
    if (!image) return {};
    Picture picture{std::min<int>(size.width, screen_->width_in_pixels),
                    std::min<int>(size.height, screen_->height_in_pixels),
                    {}};
    const std::uint8_t* data = xcb_get_image_data(image.get());
    picture.bytes.assign(data, data + xcb_get_image_data_length(image.get()));
    return picture;
}

}  // namespace tessera::test
