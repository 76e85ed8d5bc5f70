#include "client/render/frame_target.h"

#include <algorithm>

namespace tessera {

FrameTarget::FrameTarget(int width, int height) : width_{width}, height_{height} {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    colour_ = GlTexture{name};
    glTextureStorage2D(name, 1, GL_RGBA8, width, height);
    glCreateFramebuffers(1, &name);
    framebuffer_ = GlFramebuffer{name};
    glNamedFramebufferTexture(name, GL_COLOR_ATTACHMENT0, colour_.name(), 0);
    glGenTextures(1, &name);  // a view's name must be unused
    linear_view_ = GlTexture{name};
    glTextureView(name, GL_TEXTURE_2D, colour_.name(), GL_SRGB8_ALPHA8, 0, 1, 0, 1);
    glCreateFramebuffers(1, &name);
    linear_framebuffer_ = GlFramebuffer{name};
    glNamedFramebufferTexture(name, GL_COLOR_ATTACHMENT0, linear_view_.name(), 0);
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    depth_ = GlTexture{name};
    glTextureStorage2D(name, 1, GL_DEPTH_COMPONENT32F, width, height);
    for (const GlFramebuffer* framebuffer : {&framebuffer_, &linear_framebuffer_})
        glNamedFramebufferTexture(framebuffer->name(), GL_DEPTH_ATTACHMENT, name, 0);
}

void FrameTarget::bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, width_, height_);
    glDisable(GL_FRAMEBUFFER_SRGB);
}

void FrameTarget::bind_linear() const {
    glBindFramebuffer(GL_FRAMEBUFFER, linear_framebuffer_.name());
    glViewport(0, 0, width_, height_);
    glEnable(GL_FRAMEBUFFER_SRGB);
}

void FrameTarget::blit_to_window() const {
    glBlitNamedFramebuffer(framebuffer_.name(), 0, 0, 0, width_, height_, 0, 0, width_, height_,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

Rgba8Image read_framebuffer(GLuint framebuffer, int width, int height) {
    Rgba8Image image{width, height};
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.bytes.data());
    const auto row_bytes = static_cast<std::ptrdiff_t>(width) * 4;  // GL counts rows from the bottom
    for (int y = 0; y < height / 2; ++y)
        std::swap_ranges(image.row(y), image.row(y) + row_bytes, image.row(height - 1 - y));
    return image;
}

}  // namespace tessera
