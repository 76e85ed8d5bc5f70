#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "client/render/filter_pass.h"
#include "client/render/integral_store.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// All levels of a square, opaque image that repeats for ever: what filters read where there are no pages, to
/// compare with. sRGB-coded; each level is the box average of level 0 in linear light.
class WholeTexture {
  public:
    static constexpr std::int32_t least_side = 2, most_side = 2048;

    /// `levels`: of sides 2^k, 2^(k − 1), …, 1, as averaged_levels() makes them. Needs a current context.
    explicit WholeTexture(std::vector<Rgba8Image> levels);

    /// Sums lines, for Filter::line_integral. Error: io_failure with the driver's words.
    Result<void> bring_integrals();

    int side_log2() const { return side_log2_; }
    TexelTextures textures() const {
        return {.colour = texture_.name(),
                .coded = 0,
                .table = 0,
                .integrals = integrals_ ? integrals_->texture() : 0};
    }

  private:
    int side_log2_;
    GlTexture texture_;
    std::vector<Rgba8Image> levels_;
    std::unique_ptr<IntegralStore> integrals_;
};

/// The levels of a square image of side 2^k: each texel the average of those of level 0 that it covers, in
/// linear light, rounded once.
std::vector<Rgba8Image> averaged_levels(const Rgba8Image& image);

}  // namespace tessera
