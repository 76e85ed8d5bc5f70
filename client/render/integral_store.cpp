#include "client/render/integral_store.h"

#include <algorithm>
#include <array>
#include <string>

#include "shared/math/srgb.h"

namespace tessera {
namespace {

constexpr std::size_t side = IntegralStore::side_texels, channels = 4, line_words = channels * side;

/// Writes, for each texel of both kinds of lines, the sum before it above its code. Lines along x are written
/// transposed.
void sum_lines(const std::uint8_t* texels, std::size_t row_bytes, std::uint32_t* along_y,
               std::uint32_t* along_x) {
    std::array<std::uint32_t, line_words> columns{};
    for (std::size_t y = 0; y < side; ++y, texels += row_bytes) {
        std::array<std::uint32_t, channels> row{};
        for (std::size_t x = 0; x < side; ++x) {
            for (std::size_t c = 0; c < channels; ++c) {
                const std::uint8_t code = texels[channels * x + c];
                const std::uint32_t steps = c == 3 ? 257U * code : srgb_to_steps[code];
                std::uint32_t& column = columns[channels * x + c];
                along_y[y * line_words + channels * x + c] = column << 8 | code;
                along_x[x * line_words + channels * y + c] = row[c] << 8 | code;
                column += steps;
                row[c] += steps;
            }
        }
    }
}

}  // namespace

Result<std::unique_ptr<IntegralStore>> IntegralStore::make(std::size_t pages) {
    GLint most_layers = 0;
    glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most_layers);
    if (2 * pages > static_cast<std::size_t>(most_layers))
        return Error{ErrorCode::io_failure, "line integrals of " + std::to_string(pages) + " pages need " +
                                                std::to_string(2 * pages) + " layers, and the driver has " +
                                                std::to_string(most_layers) + "; use --cache-pages " +
                                                std::to_string(most_layers / 2)};
    std::unique_ptr<IntegralStore> made{new IntegralStore{pages}};
    if (glGetError() == GL_OUT_OF_MEMORY)
        return Error{ErrorCode::io_failure, "the driver has no " + std::to_string(made->bytes() >> 20) +
                                                " MiB for line integrals; use fewer --cache-pages"};
    return made;
}

IntegralStore::IntegralStore(std::size_t pages) : pages_{pages}, words_(2 * side * line_words) {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
    texture_ = GlTexture{name};
    glTextureStorage3D(name, 1, GL_RGBA32UI, side_texels, side_texels, static_cast<GLsizei>(2 * pages));
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void IntegralStore::upload(int page, std::string_view texels, int gutter) {
    const auto border = static_cast<std::size_t>(gutter);
    const std::size_t row_bytes = channels * (side + 2 * border);
    sum_lines(reinterpret_cast<const std::uint8_t*>(texels.data()) + border * row_bytes + channels * border,
              row_bytes, words_.data(), words_.data() + side * line_words);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage3D(texture_.name(), 0, 0, 0, 2 * page, side_texels, side_texels, 2, GL_RGBA_INTEGER,
                        GL_UNSIGNED_INT, words_.data());
}

void IntegralStore::upload_from(GLuint coded_pages, int gutter, int layer, int page) {
    const GLsizei width = side_texels + 2 * gutter;
    std::string texels(channels * static_cast<std::size_t>(width) * static_cast<std::size_t>(width), '\0');
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glGetTextureSubImage(coded_pages, 0, 0, 0, layer, width, width, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                         static_cast<GLsizei>(texels.size()), texels.data());
    upload(page, texels, gutter);
}

void IntegralStore::copy_from(const IntegralStore& other) {
    glCopyImageSubData(other.texture_.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, texture_.name(),
                       GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, side_texels, side_texels,
                       static_cast<GLsizei>(2 * std::min(pages_, other.pages_)));
}

}  // namespace tessera
