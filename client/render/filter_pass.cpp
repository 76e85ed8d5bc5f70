#include "client/render/filter_pass.h"

#include <bit>
#include <cmath>

#include "client/render/held_sprites.h"
#include "client/render/shader_program.h"
#include "client/render/surface_geometry.h"

namespace tessera {
namespace {

GlSampler make_sampler(GLint filter, GLint mip_filter, GLint wrap, float anisotropy = 1) {
    GLuint name = 0;
    glCreateSamplers(1, &name);
    glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, mip_filter);
    glSamplerParameteri(name, GL_TEXTURE_MAG_FILTER, filter);
    glSamplerParameteri(name, GL_TEXTURE_WRAP_S, wrap);
    glSamplerParameteri(name, GL_TEXTURE_WRAP_T, wrap);
    if (anisotropy > 1) glSamplerParameterf(name, GL_TEXTURE_MAX_ANISOTROPY_EXT, anisotropy);
    return GlSampler{name};
}

GlBuffer make_block(std::size_t bytes) {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    glNamedBufferStorage(name, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_STORAGE_BIT);
    return GlBuffer{name};
}

}  // namespace

void SourceBlock::set_window(int side) {
    window_side = side;
    window_log2 = std::countr_zero(static_cast<unsigned>(side));
    // The page at the origin reaches up to a page to each side
    window_scale = 1 / static_cast<float>(page_side_texels * (side / 2 - 1));
}

void SourceBlock::set_bias(double bias) {
    lod_bias = static_cast<float>(bias);
    squared_bias = static_cast<float>(std::exp2(2 * bias));
}

void SourceBlock::set_origin(const PlanePoint& origin) {
    origin_page[0] = static_cast<std::int32_t>(origin.x >> 8);
    origin_page[1] = static_cast<std::int32_t>(origin.y >> 8);
    origin_texel[0] = static_cast<float>(static_cast<double>(origin.x & 255) + origin.fraction_x);
    origin_texel[1] = static_cast<float>(static_cast<double>(origin.y & 255) + origin.fraction_y);
}

void SourceBlock::set_extent(Extent extent, const PlanePoint& origin) {
    const PlanePoint low{}, high{extent.side_texels(), extent.side_texels(), 0, 0};
    extent_low[0] = static_cast<float>(distance_x(origin, low));
    extent_low[1] = static_cast<float>(distance_y(origin, low));
    extent_high[0] = static_cast<float>(distance_x(origin, high));
    extent_high[1] = static_cast<float>(distance_y(origin, high));
    top_level = extent.n;
}

FilterPass::FilterPass(std::size_t picture_block_bytes)
    : blocks_{make_block(sizeof(SourceBlock)), make_block(picture_block_bytes),
              make_block(sizeof(HeldSprites::Block))},
      linear_clamped_{make_sampler(GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_EDGE)},
      linear_repeating_{make_sampler(GL_LINEAR, GL_LINEAR_MIPMAP_NEAREST, GL_REPEAT)},
      nearest_{make_sampler(GL_NEAREST, GL_NEAREST, GL_CLAMP_TO_EDGE)},
      mip_mapped_{make_sampler(GL_LINEAR, GL_LINEAR_MIPMAP_LINEAR, GL_CLAMP_TO_EDGE)} {
    if (has_driver_anisotropy()) {
        driver_clamped_ = make_sampler(GL_LINEAR, GL_LINEAR, GL_CLAMP_TO_EDGE, 16);
        driver_repeating_ = make_sampler(GL_LINEAR, GL_LINEAR_MIPMAP_LINEAR, GL_REPEAT, 16);
    }
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    no_vertices_ = GlVertexArray{name};
}

Result<GLuint> FilterPass::program(ShaderVariant variant) {
    if (variant.filter.filter != Filter::supersample) variant.filter.subsamples = 0;
    variant.filter.columns = 0;  // a uniform
    if (const auto found = programs_.find(variant); found != programs_.end()) return found->second.name();
    if (variant.filter.filter == Filter::driver_anisotropic && !has_driver_anisotropy())
        return Error{ErrorCode::io_failure, "this driver has no anisotropic sampler"};
    auto made = make_program(vertex_source(variant), fragment_source(variant));
    if (!made) return made.error();
    return programs_.emplace(variant, std::move(made.value())).first->second.name();
}

Result<void> FilterPass::prepare(const ShaderVariant& variant) {
    if (const auto made = program(variant); !made) return made.error();
    return {};
}

Result<void> FilterPass::draw(const ShaderVariant& variant, const SourceBlock& source,
                              std::span<const std::byte> picture_block, const TexelTextures& texels,
                              const SurfaceGeometry* geometry) {
    const auto made = program(variant);
    if (!made) return made.error();
    glNamedBufferSubData(blocks_[0].name(), 0, sizeof source, &source);
    glNamedBufferSubData(blocks_[1].name(), 0, static_cast<GLsizeiptr>(picture_block.size()),
                         picture_block.data());
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glUseProgram(*made);
    if (variant.held_sprites)
        glNamedBufferSubData(blocks_[2].name(), 0, sizeof(HeldSprites::Block), &texels.held->block());
    for (GLuint block = 0; block < 3; ++block)
        glBindBufferBase(GL_UNIFORM_BUFFER, block, blocks_[block].name());
    const bool by_driver = variant.filter.filter == Filter::driver_anisotropic;
    const GlSampler& colour = by_driver ? (variant.whole ? driver_repeating_ : driver_clamped_)
                                        : (variant.whole ? linear_repeating_ : linear_clamped_);
    const GLuint units[] = {texels.colour, texels.coded, texels.table, texels.integrals};
    for (GLuint unit = 0; unit < 4; ++unit) {
        glBindTextureUnit(unit, units[unit]);
        glBindSampler(unit, unit == 0 ? colour.name() : nearest_.name());
    }
    if (variant.held_sprites) {
        const GLuint held[] = {texels.held->map_texture(), texels.held->list_texture(),
                               texels.held->pattern_texture()};
        for (GLuint unit = 0; unit < 3; ++unit) {
            glBindTextureUnit(4 + unit, held[unit]);
            glBindSampler(4 + unit, unit == 2 ? mip_mapped_.name() : nearest_.name());
        }
    }
    if (variant.overlay == Overlay::revision) {
        glBindTextureUnit(7, texels.marks);
        glBindSampler(7, nearest_.name());
    }
    if (variant.filter.filter == Filter::line_integral && !variant.whole) {
        glBindTextureUnit(9, texels.integral_table);
        glBindSampler(9, nearest_.name());
    }
    if (variant.fading || variant.overlay != Overlay::none) {
        glBindTextureUnit(8, texels.entries);
        glBindSampler(8, nearest_.name());
    }
    if (variant.feedback) glBindImageTexture(0, texels.feedback, 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R32UI);
    glBindVertexArray(no_vertices_.name());
    if (geometry)
        geometry->draw(variant.feedback);
    else
        glDrawArrays(GL_TRIANGLES, 0, 3);
    for (GLuint unit = 0; unit < 10; ++unit) glBindSampler(unit, 0);
    return {};
}

}  // namespace tessera
