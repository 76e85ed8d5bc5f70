#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/prepare/perceptual.h"
#include "server/prepare/tile.h"
#include "server/progress/progress.h"

namespace tessera {

/// A periodic tile quilted of blocks from all over the photograph: each of its texels is one of the
/// photograph's.
struct QuiltedTile {
    std::int32_t side = 0;
    std::vector<PhotoPoint> sources;  ///< side²: where each texel is from.
    PerceptualImage colors;           ///< side²
    std::uint64_t seam_cost = 0;      ///< Summed prices of the cuts.

    PerceptualColor color(std::int32_t x, std::int32_t y) const noexcept {
        return colors.at(x & (side - 1), y & (side - 1));
    }
    PhotoPoint source(std::int32_t x, std::int32_t y) const noexcept {
        return sources[static_cast<std::size_t>((y & (side - 1)) * side + (x & (side - 1)))];
    }
};

/// The least photograph that a tile can be quilted of, in texels a side.
inline constexpr std::int32_t least_quilted_photo = 20;

/// Efros, Freeman, "Image quilting for texture synthesis and transfer", SIGGRAPH 2001, on the torus: blocks
/// are laid row by row where they fit what lies there already, the last of a row also the first. Where the
/// paper cuts overlaps by dynamic programming, left and top one by one, a minimum cut takes them all at once,
/// since on the torus they close to rings. Several beginnings are tried, and the quilt with the cheapest cuts
/// is taken. `side` is a power of two, 16 to 4096; the photograph at least least_quilted_photo a side. Empty
/// if stopped.
QuiltedTile quilt_tile(const PerceptualImage& photo, std::int32_t side, std::uint64_t seed,
                       std::size_t threads, Progress& progress);

}  // namespace tessera
