#include "client/render/glfw_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace tessera {
namespace {

Error glfw_error(const char* what) {
    const char* words = nullptr;
    glfwGetError(&words);
    return {ErrorCode::io_failure, std::string{what} + ": " + (words ? words : "no reason given") +
                                       "; without a display, use --headless"};
}

}  // namespace

Result<std::unique_ptr<GlfwWindow>> GlfwWindow::open(const std::string& title, Size size, bool visible) {
    if (!glfwInit()) return glfw_error("no window can be opened");
    glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_API);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
    GLFWwindow* window = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
    if (!window) {
        const Error error = glfw_error("no window with OpenGL 4.5 can be opened");
        glfwTerminate();
        return error;
    }
    std::unique_ptr<GlfwWindow> made{new GlfwWindow{window}};
    glfwMakeContextCurrent(window);
    if (const auto checked = check_gl_version(); !checked) return checked.error();
    glfwSwapInterval(1);
    return made;
}

GlfwWindow::~GlfwWindow() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

GlfwWindow::Size GlfwWindow::framebuffer_size() const {
    Size size;
    glfwGetFramebufferSize(window_, &size.width, &size.height);
    return size;
}

float GlfwWindow::content_scale() const {
    float scale_x = 1, scale_y = 1;
    glfwGetWindowContentScale(window_, &scale_x, &scale_y);
    return scale_x > 0 ? scale_x : 1;
}

bool GlfwWindow::should_close() const { return glfwWindowShouldClose(window_) != 0; }
void GlfwWindow::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }
void GlfwWindow::swap() { glfwSwapBuffers(window_); }

}  // namespace tessera
