#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/texture/exemplar_texels.h"
#include "server/texture/patch_map.h"

namespace tessera {

/// A linear colour, in steps of 1/65535.
using ColorSteps = std::array<double, 3>;

/// The stamps of content exchange: for each patch p and content c the blending weight of p times (c − mean),
/// box filtered at every level from 1 to the level where the tile is one texel, cropped to the patch map's
/// spans and packed (Lutz et al. 2019, sections 4.2, 4.4, 4.5).
///
/// Departure from the paper, which stores weight·content in 8 bits: taking the tile's mean colour out leaves
/// signed stamps whose sum is zero for a constant exemplar, exactly, whatever the rounding of the weights;
/// and floats end the darkening by up to 18 codes that 8-bit stamps cause far away.
class Stamps {
  public:
    Stamps(const PatchMap& map, const ExemplarTexels& texels, const ColorSteps& mean);

    /// The stamp's first texel: RGB, linear, 1.0 is white; a span's texels are at span.offset·3.
    const float* stamp(int level, std::size_t patch, std::size_t content) const noexcept {
        const Level& in = levels_[std::size_t(level)];
        return in.values.data() + in.patch_begin[patch] + content * in.content_stride[patch];
    }
    std::size_t memory_bytes() const noexcept;

    /// The stamps of one level.
    struct Level {
        std::vector<std::size_t> patch_begin;     ///< In floats.
        std::vector<std::size_t> content_stride;  ///< In floats.
        std::vector<float> values;
    };
    const Level& level(int level) const noexcept { return levels_[std::size_t(level)]; }

  private:
    std::vector<Level> levels_;  ///< [0] is empty: level 0 blends exemplar texels.
};

}  // namespace tessera
