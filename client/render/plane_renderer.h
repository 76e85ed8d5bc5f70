#pragma once

#include <cstdint>

#include "client/render/filter.h"
#include "client/render/filter_pass.h"
#include "client/render/frame_target.h"
#include "client/render/overlay.h"
#include "client/render/surface_geometry.h"
#include "client/residency/plane_view.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

struct PlaneStyle {
    FilterChoice filter{};
    double lod_bias = 0;       ///< Added to each pixel's level.
    std::uint32_t now_ms = 0;  ///< On the clock of TableEntry::arrival_ms.
    float fade_ms = 0;         ///< How long a new page takes to fade in; 0: at once, and cheaper.
    bool haze = true;          ///< The plane fades into the sky towards the horizon.
    Overlay overlay = Overlay::none;
    int first_column = 0;      ///< Only pixels from this one, counted from the left,
    int end_column = 1 << 20;  ///< and before this one are drawn.
    bool feedback = false;     ///< Also tells which pages were read, slowly: TexelTextures::feedback.
};

/// Draws a surface, and the sky above it.
class PlaneRenderer {
  public:
    /// Needs a current context.
    explicit PlaneRenderer(Extent extent);

    /// Compiles what this style needs, if need be. Error: io_failure with the driver's words.
    Result<void> prepare(const PlaneStyle& style);

    /// The clip centre of `view` lies inside the extent, and was the last that the page table in `texels`
    /// moved to. Error: as in prepare().
    Result<void> draw(const FrameTarget& target, const PlaneView& view, const TexelTextures& texels,
                      int window_side, const PlaneStyle& style);

  private:
    Extent extent_;
    FilterPass pass_;
    SurfaceGeometry geometry_;
};

}  // namespace tessera
