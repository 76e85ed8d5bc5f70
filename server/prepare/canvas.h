#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/prepare/perceptual.h"
#include "server/prepare/tile.h"

namespace tessera {

/// An image on its way, laid together of blocks of the photograph. It may be a torus.
struct Canvas {
    std::int32_t width = 0, height = 0;
    bool wraps = false;
    std::vector<PhotoPoint> sources;      ///< Where each texel is from.
    std::vector<PerceptualColor> colors;  ///< Of each texel.
    std::vector<std::uint8_t> laid;       ///< Something is there.
    std::uint64_t seam_cost = 0;          ///< Summed prices of the cuts.

    Canvas(std::int32_t w, std::int32_t h, bool on_torus);
    std::size_t index(std::int32_t x, std::int32_t y) const noexcept {
        if (wraps) x %= width, y %= height;
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    /// Puts a photograph's texel there.
    void put(std::int32_t x, std::int32_t y, PhotoPoint from, const PerceptualImage& photo) {
        const std::size_t i = index(x, y);
        sources[i] = from;
        colors[i] = photo.at(from.x, from.y);
        laid[i] = 1;
    }
};

/// A rectangle of a canvas; on a torus it may reach over the end.
struct CanvasBlock {
    std::int32_t x = 0, y = 0, width = 0, height = 0;
};

/// Places of the photograph for a block's first texel; the block lies inside the photograph.
struct PlaceWindow {
    std::int32_t x = 0, y = 0, width = 0, height = 0;
};
PlaceWindow all_places(const PerceptualImage& photo, const CanvasBlock& block);

/// The places in the window where the block fits best what lies there already, at most `count`, the best
/// first: on a coarse grid of places and texels, then ever finer around the best, which may leave the window
/// by a few texels.
std::vector<PhotoPoint> best_places(const PerceptualImage& photo, const Canvas& canvas,
                                    const CanvasBlock& block, const PlaceWindow& window, std::size_t count);

/// Which sides of a block end on what lies there already, as far as something does.
enum class BlockRim : std::uint8_t { all, left_and_right, top_and_bottom };

/// Lays the photograph's block over what is there, divided by a minimum cut where it shows least. Where
/// nothing lies the block does.
void lay_block(Canvas& canvas, const PerceptualImage& photo, const CanvasBlock& block, PhotoPoint at,
               BlockRim rim);

/// Lays that of the places whose cut is cheapest; there is at least one.
void lay_cheapest(Canvas& canvas, const PerceptualImage& photo, const CanvasBlock& block,
                  const std::vector<PhotoPoint>& places, BlockRim rim);

}  // namespace tessera
