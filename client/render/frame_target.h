#pragma once

#include "client/render/gl_objects.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// Waits for a framebuffer's picture (0: the window's own); rows from the top.
Rgba8Image read_framebuffer(GLuint framebuffer, int width, int height);

/// What every frame is drawn into, with or without a window: RGBA, 8 bits a channel, coded for display, and
/// depths in floats.
class FrameTarget {
  public:
    FrameTarget(int width, int height);

    /// Draws go here from now on, and write codes.
    void bind() const;
    /// The same, but draws write linear light, which is coded on its way in while GL_FRAMEBUFFER_SRGB is
    /// enabled: it is now.
    void bind_linear() const;
    /// Copies the picture to the window's framebuffer, which has the same size.
    void blit_to_window() const;
    /// Waits for the picture; rows from the top.
    Rgba8Image read() const { return read_framebuffer(framebuffer_.name(), width_, height_); }

    int width() const { return width_; }
    int height() const { return height_; }

  private:
    int width_;
    int height_;
    GlTexture colour_, linear_view_, depth_;
    GlFramebuffer framebuffer_, linear_framebuffer_;
};

}  // namespace tessera
