#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "client/render/frame_target.h"
#include "client/render/gl_objects.h"
#include "client/render/page_store.h"
#include "client/render/page_table_texture.h"
#include "client/residency/plane_view.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

enum class Filter {
    trilinear,  ///< Linear within and between levels, in linear light.
    stored,     ///< The nearest texel of the nearest level, as stored, with no haze: for tests and tools.
};

struct PlaneStyle {
    Filter filter = Filter::trilinear;
    double lod_bias = 0;        ///< Added to each pixel's level.
    std::uint32_t now_ms = 0;   ///< On the clock of TableEntry::arrival_ms.
    float fade_ms = 0;          ///< How long a new page takes to fade in; 0: at once, and cheaper.
    bool haze = true;           ///< The plane fades into the sky towards the horizon.
    bool page_borders = false;  ///< Draws the borders of the pages shown, coloured by level.
};

/// Draws the plane and the sky above it, one fragment shader over the whole picture.
class PlaneRenderer {
  public:
    /// Needs a current context. Error: io_failure with the driver's words.
    static Result<std::unique_ptr<PlaneRenderer>> make(Extent extent);

    /// The clip centre of `view` lies inside the extent, and was the last that `table` moved to.
    void draw(const FrameTarget& target, const PlaneView& view, const PageStore& pages,
              const PageTableTexture& table, int window_side, const PlaneStyle& style);

  private:
    /// The fragment shader's variants: stored_texels, or any of the others together.
    static constexpr std::size_t fading = 1, page_borders = 2, stored_texels = 4, variants = 5;

    explicit PlaneRenderer(Extent extent);

    Extent extent_;
    std::array<GlProgram, variants> programs_;
    GlBuffer frame_block_;
    GlVertexArray no_vertices_;
    GlSampler linear_;
    GlSampler nearest_;
};

}  // namespace tessera
