#include "client/render/shader_program.h"

#include <initializer_list>
#include <string>

namespace tessera {
namespace {

Result<GlShader> compile(GLenum kind, std::string_view source) {
    GlShader shader{glCreateShader(kind)};
    const char* text = source.data();
    const auto length = static_cast<GLint>(source.size());
    glShaderSource(shader.name(), 1, &text, &length);
    glCompileShader(shader.name());
    GLint compiled = 0;
    glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
    if (compiled) return shader;
    char log[4096] = "";
    glGetShaderInfoLog(shader.name(), sizeof log, nullptr, log);
    return Error{ErrorCode::io_failure, std::string{"the driver refuses a shader: "} + log};
}

Result<GlProgram> link(std::initializer_list<GLuint> shaders) {
    GlProgram program{glCreateProgram()};
    for (const GLuint shader : shaders) glAttachShader(program.name(), shader);
    glLinkProgram(program.name());
    GLint linked = 0;
    glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
    if (linked) return program;
    char log[4096] = "";
    glGetProgramInfoLog(program.name(), sizeof log, nullptr, log);
    return Error{ErrorCode::io_failure, std::string{"the driver cannot link a shader: "} + log};
}

}  // namespace

Result<GlProgram> make_program(std::string_view vertex_source, std::string_view fragment_source) {
    auto vertex = compile(GL_VERTEX_SHADER, vertex_source);
    if (!vertex) return vertex.error();
    auto fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
    if (!fragment) return fragment.error();
    return link({vertex->name(), fragment->name()});
}

}  // namespace tessera
