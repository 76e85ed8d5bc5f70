#pragma once

#include <memory>
#include <string>

#include "shared/result/result.h"

namespace tessera {

/// An OpenGL 4.5 core context, current on the thread that made it until it is destroyed. One at a time.
class GlContext {
  public:
    virtual ~GlContext() = default;
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;

  protected:
    GlContext() = default;
};

/// A context without window, display or X server: EGL's surfaceless platform. It has no framebuffer of its
/// own. Works on a machine with no GPU, by Mesa's software rasteriser. Error: io_failure.
Result<std::unique_ptr<GlContext>> make_headless_context();

/// "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5": of the current context.
std::string gl_description();

/// The current context as an error if it is older than OpenGL 4.5.
Result<void> check_gl_version();

}  // namespace tessera
