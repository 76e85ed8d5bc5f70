#include "client/render/situation_renderer.h"

#include <algorithm>

namespace tessera {
namespace {

constexpr std::size_t most_surfaces = 4;

/// The uniform block `Surfaces` of shaders/situation.frag, in std140.
struct SurfacesBlock {
    float rows[3 * most_surfaces][4];
    float middle[2];
    std::int32_t surfaces;
    std::int32_t unused;
};
static_assert(sizeof(SurfacesBlock) == 208);

SurfacesBlock block_of(const Situation& situation) {
    SurfacesBlock block{};
    const double x = situation.width / 2.0, y = situation.height / 2.0;
    block.middle[0] = static_cast<float>(x);
    block.middle[1] = static_cast<float>(y);
    block.surfaces = static_cast<std::int32_t>(std::min(situation.surfaces.size(), most_surfaces));
    for (std::size_t row = 0; row < 3 * static_cast<std::size_t>(block.surfaces); ++row) {
        // Counted from the picture's middle: floats are finest there, and the horizon is near it
        const double* m = situation.surfaces[row / 3].to_texels.data() + row % 3 * 3;
        block.rows[row][0] = static_cast<float>(m[0]);
        block.rows[row][1] = static_cast<float>(m[1]);
        block.rows[row][2] = static_cast<float>(m[2] + m[0] * x + m[1] * y);
    }
    return block;
}

ShaderVariant variant_of(FilterChoice filter, bool whole, bool count_fetches) {
    return {.picture = ShaderVariant::Picture::situation,
            .filter = filter,
            .whole = whole,
            .count_fetches = count_fetches};
}

}  // namespace

SituationRenderer::SituationRenderer(std::int32_t width, std::int32_t height)
    : width_{width}, height_{height}, pass_{sizeof(SurfacesBlock)} {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    colour_ = GlTexture{name};
    glTextureStorage2D(name, 1, GL_RGBA32F, width, height);
    glCreateFramebuffers(1, &name);
    framebuffer_ = GlFramebuffer{name};
    glNamedFramebufferTexture(name, GL_COLOR_ATTACHMENT0, colour_.name(), 0);
}

Result<void> SituationRenderer::draw(const Situation& situation, const SourceBlock& source,
                                     const TexelTextures& texels, const ShaderVariant& variant) {
    const SurfacesBlock block = block_of(situation);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, width_, height_);
    glDisable(GL_SCISSOR_TEST);
    return pass_.draw(variant, source, std::as_bytes(std::span{&block, 1}), texels);
}

Result<void> SituationRenderer::draw(const Situation& situation, const WholeTexture& texture,
                                     FilterChoice filter, bool count_fetches) {
    SourceBlock source;
    source.set_origin({situation.origin_x, situation.origin_y, 0, 0});
    source.top_level = source.side_log2 = texture.side_log2();
    source.most_columns = static_cast<float>(filter.columns);
    return draw(situation, source, texture.textures(), variant_of(filter, true, count_fetches));
}

Result<void> SituationRenderer::draw(const Situation& situation, const TexelTextures& pages, Extent extent,
                                     int window_side, FilterChoice filter, bool count_fetches) {
    SourceBlock source;
    const PlanePoint origin{situation.origin_x, situation.origin_y, 0, 0};
    source.set_origin(origin);
    source.set_extent(extent, origin);
    source.set_window(window_side);
    source.most_columns = static_cast<float>(filter.columns);
    return draw(situation, source, pages, variant_of(filter, false, count_fetches));
}

FloatPicture SituationRenderer::read() const {
    FloatPicture picture{width_, height_, {}};
    const auto row = 4 * static_cast<std::size_t>(width_);
    picture.values.resize(row * static_cast<std::size_t>(height_));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, width_, height_, GL_RGBA, GL_FLOAT, picture.values.data());
    // GL counts rows from the bottom
    for (std::size_t y = 0; y < static_cast<std::size_t>(height_) / 2; ++y)
        std::swap_ranges(picture.values.begin() + static_cast<std::ptrdiff_t>(row * y),
                         picture.values.begin() + static_cast<std::ptrdiff_t>(row * (y + 1)),
                         picture.values.end() - static_cast<std::ptrdiff_t>(row * (y + 1)));
    return picture;
}

}  // namespace tessera
