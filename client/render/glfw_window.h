#pragma once

#include <memory>
#include <string>

#include "client/render/gl_context.h"

struct GLFWwindow;

namespace tessera {

/// A window with an OpenGL 4.5 core context. One at a time, on the main thread.
class GlfwWindow : public GlContext {
  public:
    struct Size {
        int width = 0;
        int height = 0;
        bool operator==(const Size&) const = default;
    };

    /// `visible` false: for tests. Error: io_failure (no display, no such context).
    static Result<std::unique_ptr<GlfwWindow>> open(const std::string& title, Size size, bool visible = true);
    ~GlfwWindow() override;

    GLFWwindow* handle() const { return window_; }
    /// In pixels; 0 × 0 while the window is minimised.
    Size framebuffer_size() const;
    /// How much larger than at 96 dpi text should be drawn.
    float content_scale() const;
    bool should_close() const;
    void set_title(const std::string& title);
    void swap();

  private:
    explicit GlfwWindow(GLFWwindow* window) : window_{window} {}
    GLFWwindow* window_;
};

}  // namespace tessera
