#pragma once

#include <cstdint>
#include <vector>

#include "client/render/filter_pass.h"
#include "client/render/whole_texture.h"
#include "shared/situations/situation.h"

namespace tessera {

/// A picture in floats: what filters are measured on, before anything is rounded.
struct FloatPicture {
    std::int32_t width = 0, height = 0;
    std::vector<float> values;  ///< 4·width·height, rows from the top; see SituationRenderer.

    const float* pixel(std::int32_t x, std::int32_t y) const {
        return values.data() + 4 * (std::size_t(y) * std::size_t(width) + std::size_t(x));
    }
};

/// Draws situations through any filter into a picture of floats: premultiplied linear light in red, green and
/// blue; in alpha, if asked, the texels that were read for the pixel; −1 where there is no surface.
class SituationRenderer {
  public:
    /// Needs a current context. Pixels: 16 to 8192 each way.
    SituationRenderer(std::int32_t width, std::int32_t height);

    /// Starts drawing; finish() or read() waits for the end. `situation` has this renderer's size and at most
    /// four surfaces. Error: io_failure with the driver's words.
    Result<void> draw(const Situation& situation, const WholeTexture& texture, FilterChoice filter,
                      bool count_fetches = false);
    /// The same from pages: `table` was last moved to the situation's origin, which lies inside the extent.
    Result<void> draw(const Situation& situation, const TexelTextures& pages, Extent extent, int window_side,
                      FilterChoice filter, bool count_fetches = false);

    void finish() const { glFinish(); }
    FloatPicture read() const;

  private:
    Result<void> draw(const Situation& situation, const SourceBlock& source, const TexelTextures& texels,
                      const ShaderVariant& variant);

    std::int32_t width_, height_;
    FilterPass pass_;
    GlTexture colour_;
    GlFramebuffer framebuffer_;
};

}  // namespace tessera
