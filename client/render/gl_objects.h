#pragma once

#include <utility>

#include <epoxy/gl.h>

namespace tessera {

/// Owns the name of a GL object. `Free` deletes one name.
template <void (*Free)(GLuint)>
class GlObject {
  public:
    GlObject() = default;
    explicit GlObject(GLuint name) : name_{name} {}
    GlObject(GlObject&& other) noexcept : name_{std::exchange(other.name_, 0)} {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~GlObject() {
        if (name_ != 0) Free(name_);
    }
    GLuint name() const { return name_; }

  private:
    GLuint name_ = 0;
};

// libepoxy's entry points are macros of function pointers: each needs a function around it
inline void free_texture(GLuint name) { glDeleteTextures(1, &name); }
inline void free_buffer(GLuint name) { glDeleteBuffers(1, &name); }
inline void free_framebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }
inline void free_vertex_array(GLuint name) { glDeleteVertexArrays(1, &name); }
inline void free_sampler(GLuint name) { glDeleteSamplers(1, &name); }
inline void free_program(GLuint name) { glDeleteProgram(name); }
inline void free_shader(GLuint name) { glDeleteShader(name); }

using GlTexture = GlObject<free_texture>;
using GlBuffer = GlObject<free_buffer>;
using GlFramebuffer = GlObject<free_framebuffer>;
using GlVertexArray = GlObject<free_vertex_array>;
using GlSampler = GlObject<free_sampler>;
using GlProgram = GlObject<free_program>;
using GlShader = GlObject<free_shader>;

}  // namespace tessera
