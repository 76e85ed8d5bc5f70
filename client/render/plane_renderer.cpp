#include "client/render/plane_renderer.h"

#include <cmath>
#include <string>

#include "plane_frag.h"
#include "plane_vert.h"

#include "client/render/shader_program.h"

namespace tessera {
namespace {

/// Of one level: the page that holds the clip centre, and where in that page the centre lies. Positions in
/// the shader are relative to it, so that floats are exact enough at any place of any extent.
struct LevelOrigin {
    std::int32_t page[2];
    float offset[2];  ///< In texels of the level, 0 to 256.
};

/// The uniform block `Frame` of shaders/plane.frag, in std140.
struct FrameBlock {
    float forward[4];
    float right[4];  ///< × tangent of half the horizontal field of view
    float up[4];     ///< × tangent of half the vertical field of view
    float height;
    float pixel_step;
    float across_slope;  ///< Across, −1 to 1, times this is the across · cos pitch of PlaneView::level_at.
    float lod_bias;
    float extent_low[2];  ///< The extent's corners relative to the eye
    float extent_high[2];
    float picture[2];
    std::int32_t top_level;
    std::int32_t window_side;
    std::uint32_t now_ms;
    float fade_ms;
    float haze;  ///< 1, or 0 without
    float unused;
    LevelOrigin origins[max_level + 1];
};
static_assert(sizeof(FrameBlock) == 112 + 16 * (max_level + 1));

void put(float (&target)[4], const Vector3& v, double scale) {
    target[0] = static_cast<float>(v.x * scale);
    target[1] = static_cast<float>(v.y * scale);
    target[2] = static_cast<float>(v.z * scale);
    target[3] = 0;
}

LevelOrigin origin_of(const PlanePoint& centre, int level) {
    const std::int64_t page_side = std::int64_t{page_side_texels} << level;
    const auto offset = [&](std::int64_t texel, double fraction) {
        return static_cast<float>((static_cast<double>(texel & (page_side - 1)) + fraction) *
                                  std::exp2(-level));
    };
    return {{static_cast<std::int32_t>(centre.x >> (8 + level)),
             static_cast<std::int32_t>(centre.y >> (8 + level))},
            {offset(centre.x, centre.fraction_x), offset(centre.y, centre.fraction_y)}};
}

FrameBlock block_of(const PlaneView& view, Extent extent, int window_side, const PlaneStyle& style) {
    FrameBlock block{};
    const PlanePoint &eye = view.camera().ground, low{},
                     high{extent.side_texels(), extent.side_texels(), 0, 0};
    put(block.forward, view.forward(), 1);
    put(block.right, view.right(), view.tangent_x());
    put(block.up, view.up(), view.tangent_y());
    block.height = static_cast<float>(view.camera().height_texels);
    block.pixel_step = static_cast<float>(view.pixel_step());
    block.across_slope = static_cast<float>(view.tangent_x() * view.up().z);
    block.lod_bias = static_cast<float>(style.lod_bias);
    block.extent_low[0] = static_cast<float>(distance_x(eye, low));
    block.extent_low[1] = static_cast<float>(distance_y(eye, low));
    block.extent_high[0] = static_cast<float>(distance_x(eye, high));
    block.extent_high[1] = static_cast<float>(distance_y(eye, high));
    block.picture[0] = static_cast<float>(view.width());
    block.picture[1] = static_cast<float>(view.height());
    block.top_level = extent.n;
    block.window_side = window_side;
    block.now_ms = style.now_ms;
    block.fade_ms = style.fade_ms;
    block.haze = style.haze ? 1 : 0;
    for (int level = 0; level <= extent.n; ++level) block.origins[level] = origin_of(eye, level);
    return block;
}

GlSampler make_sampler(GLint filter) {
    GLuint name = 0;
    glCreateSamplers(1, &name);
    glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, filter);
    glSamplerParameteri(name, GL_TEXTURE_MAG_FILTER, filter);
    glSamplerParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return GlSampler{name};
}

Result<GlProgram> compile(const std::string& definitions) {
    const std::string head = "#version 450 core\n" + definitions;
    return make_program(head + plane_vert_source, head + plane_frag_source);
}

}  // namespace

Result<std::unique_ptr<PlaneRenderer>> PlaneRenderer::make(Extent extent) {
    std::unique_ptr<PlaneRenderer> made{new PlaneRenderer{extent}};
    for (std::size_t variant = 0; variant < variants; ++variant) {
        std::string definitions;
        if (variant & fading) definitions += "#define FADING\n";
        if (variant & page_borders) definitions += "#define PAGE_BORDERS\n";
        if (variant == stored_texels) definitions = "#define STORED_TEXELS\n";
        auto program = compile(definitions);
        if (!program) return program.error();
        made->programs_[variant] = std::move(program.value());
    }
    return made;
}

PlaneRenderer::PlaneRenderer(Extent extent)
    : extent_{extent}, linear_{make_sampler(GL_LINEAR)}, nearest_{make_sampler(GL_NEAREST)} {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    frame_block_ = GlBuffer{name};
    glNamedBufferStorage(name, sizeof(FrameBlock), nullptr, GL_DYNAMIC_STORAGE_BIT);
    glCreateVertexArrays(1, &name);
    no_vertices_ = GlVertexArray{name};
}

void PlaneRenderer::draw(const FrameTarget& target, const PlaneView& view, const PageStore& pages,
                         const PageTableTexture& table, int window_side, const PlaneStyle& style) {
    const FrameBlock block = block_of(view, extent_, window_side, style);
    glNamedBufferSubData(frame_block_.name(), 0, sizeof block, &block);
    target.bind();
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    const std::size_t variant = style.filter == Filter::stored ? stored_texels
                                                               : (style.fade_ms > 0 ? fading : 0) |
                                                                     (style.page_borders ? page_borders : 0);
    glUseProgram(programs_[variant].name());
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, frame_block_.name());
    glBindTextureUnit(0, pages.texture());
    glBindSampler(0, linear_.name());
    glBindTextureUnit(1, pages.coded_texture());
    glBindSampler(1, nearest_.name());
    glBindTextureUnit(2, table.texture());
    glBindSampler(2, nearest_.name());
    glBindVertexArray(no_vertices_.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    for (GLuint unit = 0; unit < 3; ++unit) glBindSampler(unit, 0);
}

}  // namespace tessera
