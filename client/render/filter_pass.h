#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

#include "client/render/gl_objects.h"
#include "client/render/shader_source.h"
#include "client/residency/camera.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

class HeldSprites;
class SurfaceGeometry;

/// The uniform block `Source` of shaders/source.glsl, in std140.
struct SourceBlock {
    std::int32_t origin_page[2] = {};
    float origin_texel[2] = {};
    float extent_low[2] = {-1e30F, -1e30F};
    float extent_high[2] = {1e30F, 1e30F};
    std::int32_t top_level = 0;
    std::int32_t window_side = 1;
    std::uint32_t now_ms = 0;
    float fade_ms = 0;
    float lod_bias = 0;
    std::int32_t side_log2 = 0;
    float most_columns = 8;
    float squared_bias = 1;        ///< 4 to the power of lod_bias
    float window_scale = 0;        ///< 1 over the distance that lies in the window of level 0 for sure
    std::int32_t window_log2 = 0;  ///< Of window_side
    float unused[2] = {};

    /// Positions count from `origin`: the page of level 0 that holds it, and where in that page it lies.
    void set_origin(const PlanePoint& origin);
    void set_extent(Extent extent, const PlanePoint& origin);
    /// Of a page table.
    void set_window(int window_side);
    void set_bias(double lod_bias);
};
static_assert(sizeof(SourceBlock) == 80);

/// What a shader reads texels from; which of them, its variant says.
struct TexelTextures {
    GLuint colour = 0;                  ///< Pages, or a whole texture; decodes to linear light.
    GLuint coded = 0;                   ///< Pages as stored.
    GLuint table = 0;                   ///< The page table, as shaders read it.
    GLuint entries = 0;                 ///< The page table's full entries: who shows age, needs these.
    GLuint integrals = 0;               ///< See IntegralStore.
    GLuint integral_table = 0;          ///< Like `table`, to layers of `integrals` (PageIntegrals).
    const HeldSprites* held = nullptr;  ///< Sprites in hands, prepared for the view; null: none.
    GLuint feedback = 0;  ///< R32UI, as large as the page table: entries of pages that were read become 1.
    GLuint marks = 0;     ///< R32F, one texel a slot: see Overlay::revision.
};

/// Draws one triangle over the picture with a variant of the filter shaders. Compiles each variant when it is
/// first asked for.
class FilterPass {
  public:
    /// Needs a current context. `picture_block_bytes`: of the picture's own uniform block.
    explicit FilterPass(std::size_t picture_block_bytes);

    /// Compiles, if need be. Error: io_failure with the driver's words.
    Result<void> prepare(const ShaderVariant& variant);

    /// Into the framebuffer that is bound. Error: as in prepare().
    /// `geometry`: what is drawn instead of the triangle over the picture; of Picture::surface.
    Result<void> draw(const ShaderVariant& variant, const SourceBlock& source,
                      std::span<const std::byte> picture_block, const TexelTextures& texels,
                      const SurfaceGeometry* geometry = nullptr);

  private:
    Result<GLuint> program(ShaderVariant variant);

    std::map<ShaderVariant, GlProgram> programs_;
    std::array<GlBuffer, 3> blocks_;
    GlVertexArray no_vertices_;
    GlSampler linear_clamped_, linear_repeating_, nearest_, mip_mapped_, driver_clamped_, driver_repeating_;
};

}  // namespace tessera
