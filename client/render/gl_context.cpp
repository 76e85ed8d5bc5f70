#include "client/render/gl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

namespace tessera {
namespace {

class EglContext : public GlContext {
  public:
    EglContext(EGLDisplay display, EGLContext context) : display_{display}, context_{context} {}
    ~EglContext() override {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
        eglTerminate(display_);
    }

  private:
    EGLDisplay display_;
    EGLContext context_;
};

Error egl_error(const char* what) {
    return {ErrorCode::io_failure,
            std::string{"no OpenGL without a display: "} + what +
                "; install Mesa's EGL drivers (Debian: libegl-mesa0, libgl1-mesa-dri)"};
}

}  // namespace

Result<std::unique_ptr<GlContext>> make_headless_context() {
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        return egl_error("EGL has no surfaceless platform");
    const EGLDisplay display =
        eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr))
        return egl_error("EGL does not start");
    if (!eglBindAPI(EGL_OPENGL_API)) {
        eglTerminate(display);
        return egl_error("EGL has no desktop OpenGL");
    }
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) {
        eglTerminate(display);
        return egl_error("the driver has no OpenGL 4.5 core context");
    }
    auto made = std::make_unique<EglContext>(display, context);
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
        return egl_error("a context without a surface is refused");
    return std::unique_ptr<GlContext>{std::move(made)};
}

std::string gl_description() {
    const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    const int version = epoxy_gl_version();
    return std::string{renderer ? renderer : "unknown"} + ", OpenGL " + std::to_string(version / 10) + '.' +
           std::to_string(version % 10);
}

Result<void> check_gl_version() {
    if (epoxy_gl_version() >= 45) return {};
    return Error{ErrorCode::io_failure,
                 "OpenGL 4.5 is needed, and here is " + gl_description() +
                     "; LIBGL_ALWAYS_SOFTWARE=1 draws with Mesa's software rasteriser instead"};
}

}  // namespace tessera
