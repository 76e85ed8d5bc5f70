#include "client/render/integral_store.h"

#include <array>

#include "client/render/shader_program.h"
#include "client/render/shader_source.h"
#include "shared/math/srgb.h"

namespace tessera {

Result<std::unique_ptr<IntegralStore>> IntegralStore::make(std::size_t pages) {
    GLint most_layers = 0;
    glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most_layers);
    if (2 * pages > static_cast<std::size_t>(most_layers))
        return Error{ErrorCode::io_failure, "line integrals of " + std::to_string(pages) + " pages need " +
                                                std::to_string(2 * pages) + " layers, and the driver has " +
                                                std::to_string(most_layers) + "; use --cache-pages " +
                                                std::to_string(most_layers / 2)};
    auto program = make_compute_program(integrals_source());
    if (!program) return program.error();
    std::unique_ptr<IntegralStore> made{new IntegralStore{pages, std::move(program.value())}};
    if (glGetError() == GL_OUT_OF_MEMORY)
        return Error{ErrorCode::io_failure, "the driver has no " + std::to_string(made->bytes() >> 20) +
                                                " MiB for line integrals; use fewer --cache-pages"};
    return made;
}

IntegralStore::IntegralStore(std::size_t pages, GlProgram program)
    : pages_{pages}, program_{std::move(program)} {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
    texture_ = GlTexture{name};
    glTextureStorage3D(name, 1, GL_RGBA32UI, side_texels, side_texels, static_cast<GLsizei>(2 * pages));
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    std::array<std::uint32_t, 256> steps{};
    for (std::size_t code = 0; code < steps.size(); ++code) steps[code] = srgb_to_steps[code];
    glCreateBuffers(1, &name);
    steps_ = GlBuffer{name};
    glNamedBufferStorage(name, sizeof steps, steps.data(), 0);
}

void IntegralStore::build(GLuint coded_pages, int gutter, std::span<const int> layers) {
    if (layers.empty()) return;
    glUseProgram(program_.name());
    glBindTextureUnit(0, coded_pages);
    glBindSampler(0, 0);
    glBindImageTexture(0, texture_.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA32UI);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, steps_.name());
    glUniform1i(1, gutter);
    for (const int layer : layers) {
        glUniform1i(0, layer);
        glDispatchCompute(side_texels / 64, 2, 1);
    }
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace tessera
