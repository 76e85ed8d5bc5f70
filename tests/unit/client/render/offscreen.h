#pragma once

#include <memory>
#include <stdexcept>

#include <epoxy/gl.h>

#include "client/render/gl_context.h"
#include "client/render/plane_scene.h"
#include "tests/unit/client/residency/fake_page_source.h"

namespace tessera::testing {

inline std::unique_ptr<GlContext> headless_context() {
    auto context = make_headless_context();
    if (!context) throw std::runtime_error{context.error().detail};
    return std::move(context.value());
}

/// A scene of painted pages, drawn without a window, on a clock of 16 ms a frame.
class Offscreen {
  public:
    Offscreen(Extent extent, FakePageSource::Paint paint, int width, int height,
              ResidencySettings settings = {}, std::unique_ptr<GlContext> context = headless_context())
        : context_{std::move(context)}, source{std::move(paint)}, target{width, height} {
        auto made = PlaneScene::make(extent, source, settings);
        if (!made) throw std::runtime_error{made.error().detail};
        scene = std::move(made.value());
    }

    PlaneView view(const Camera& camera) const { return {camera, target.width(), target.height(), surface}; }

    ResidencyFrame update(const Camera& camera, FilterChoice filter = {}) {
        now += ClientTime{16};
        return scene->update(view(camera), now, filter);
    }
    /// Frames until everything needed is there.
    void settle(const Camera& camera, FilterChoice filter = {}) {
        for (int frame = 0; !update(camera, filter).is_sharp(); ++frame)
            if (frame > 1000) throw std::runtime_error{"never sharp"};
    }
    Rgba8Image draw(const Camera& camera, const PlaneStyle& style = {}, GLuint feedback = 0) {
        if (const auto drawn = scene->draw(target, view(camera), style, feedback); !drawn)
            throw std::runtime_error{drawn.error().detail};
        Rgba8Image image = target.read();
        if (const GLenum error = glGetError(); error != GL_NO_ERROR)
            throw std::runtime_error{"GL error " + std::to_string(error)};
        return image;
    }

  private:
    std::unique_ptr<GlContext> context_;  // first made, last destroyed

  public:
    FakePageSource source;
    FrameTarget target;
    std::unique_ptr<PlaneScene> scene;
    ClientTime now{};
    Surface surface{};
};

}  // namespace tessera::testing
