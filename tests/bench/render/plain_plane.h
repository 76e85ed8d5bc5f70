#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/render/frame_target.h"
#include "client/render/gl_objects.h"
#include "client/render/shader_program.h"
#include "client/residency/plane_view.h"

namespace tessera::testing {

/// A plane with one small texture of plain 8-bit codes that repeats, filtered by the driver's trilinear
/// sampler: no pages, no linear light, no haze. What a machine needs for a textured plane at least. Draws no
/// sky.
class PlainPlane {
  public:
    PlainPlane() {
        auto made = make_program(vertex, fragment);
        if (!made) throw std::runtime_error{made.error().detail};
        program_ = std::move(*made);
        GLuint name = 0;
        glCreateTextures(GL_TEXTURE_2D, 1, &name);
        texture_ = GlTexture{name};
        glTextureStorage2D(name, 11, GL_RGBA8, side, side);
        std::vector<std::uint8_t> texels(std::size_t{4} * side * side);
        for (std::size_t at = 0; at < texels.size(); ++at)
            texels[at] = static_cast<std::uint8_t>(at * 2654435761U >> 24);
        glTextureSubImage2D(name, 0, 0, 0, side, side, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
        glGenerateTextureMipmap(name);
        glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
        glCreateVertexArrays(1, &name);
        no_vertices_ = GlVertexArray{name};
    }

    /// Waits for the picture.
    void draw(const FrameTarget& target, const PlaneView& view) const {
        const Vector3 &f = view.forward(), &r = view.right(), &u = view.up();
        const auto set = [&](int at, const Vector3& v, double scale) {
            glProgramUniform3f(program_.name(), at, static_cast<float>(v.x * scale),
                               static_cast<float>(v.y * scale), static_cast<float>(v.z * scale));
        };
        set(0, f, 1);
        set(1, r, view.tangent_x());
        set(2, u, view.tangent_y());
        glProgramUniform1f(program_.name(), 3, static_cast<float>(view.camera().height_texels / side));
        target.bind();
        glUseProgram(program_.name());
        glBindTextureUnit(0, texture_.name());
        glBindSampler(0, 0);
        glBindVertexArray(no_vertices_.name());
        const double horizon = 1 - f.z / (view.tangent_y() * u.z);
        glEnable(GL_SCISSOR_TEST);
        glScissor(0, 0, view.width(),
                  std::clamp(static_cast<int>(horizon * view.height() / 2), 0, view.height()));
        glDrawArrays(GL_TRIANGLES, 0, 3);
        glDisable(GL_SCISSOR_TEST);
        glFinish();
    }

  private:
    static constexpr int side = 1024;
    static constexpr const char* vertex =
        R"(#version 450 core
layout(location = 0) uniform vec3 forward;
layout(location = 1) uniform vec3 right;
layout(location = 2) uniform vec3 up;
noperspective out vec3 ray;
void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(corner, 0.0, 1.0);
    ray = forward + corner.x * right + corner.y * up;
}
)";
    static constexpr const char* fragment =
        R"(#version 450 core
layout(location = 3) uniform float height;
layout(binding = 0) uniform sampler2D plain;
noperspective in vec3 ray;
layout(location = 0) out vec4 colour;
void main() { colour = texture(plain, height / -ray.z * ray.xy); }
)";
    GlProgram program_;
    GlTexture texture_;
    GlVertexArray no_vertices_;
};

}  // namespace tessera::testing
