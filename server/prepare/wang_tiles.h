#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/prepare/canvas.h"
#include "server/prepare/perceptual.h"
#include "server/prepare/tile.h"
#include "server/progress/progress.h"

namespace tessera {

inline constexpr std::int32_t least_wang_side = 16;
inline constexpr std::int32_t least_wang_photo = 20;

/// The corners of tile 0 to colors⁴ − 1, as ExchangeAsset::Content::corners has them.
std::uint8_t wang_corners(std::int32_t tile, std::int32_t colors);

/// Corner-coloured tiles (Lagae, Dutré, "An alternative for Wang tiles: colored edges versus colored
/// corners", ACM Transactions on Graphics 25(4), 2006) cut from a photograph. Every colour owns a sample of
/// the photograph, which lies round each corner of that colour. Between two corners lies a strip, along the
/// edge and on both sides of it, that fits both samples: one for each pair of colours. So all texels near an
/// edge depend on its two colours only, and any two tiles that share an edge show the same strip across it. A
/// tile's middle is one block that fits the four strips. All are stitched by minimum cuts.
class WangFrames {
  public:
    /// The photograph is larger than a tile by a quarter, and outlives this.
    WangFrames(const PerceptualImage& photo, std::int32_t side, std::int32_t colors, std::uint64_t seed,
               std::size_t threads, Progress& progress);

    /// Where each texel of the tile with these corners is from: side².
    std::vector<PhotoPoint> make_tile(std::uint8_t corners) const;

    /// How far from the edges texels depend on the edge's colours only, at least.
    static constexpr std::int32_t locked = 2;

  private:
    PhotoPoint sample(std::int32_t color) const { return samples_[static_cast<std::size_t>(color)]; }
    Canvas make_strip(std::int32_t from, std::int32_t to, bool across) const;
    const Canvas& strip(std::int32_t from, std::int32_t to, bool across) const;

    const PerceptualImage& photo_;
    std::int32_t side_, colors_;
    std::uint64_t seed_;
    std::int32_t half_;                ///< Of a strip's width.
    std::int32_t overlap_;             ///< Along a strip, where it may change over to a sample.
    std::vector<PhotoPoint> samples_;  ///< First texels; the corner is half_ + overlap_ further.
    std::vector<Canvas> strips_;       ///< Across, then down: from·colors + to.
};

}  // namespace tessera
