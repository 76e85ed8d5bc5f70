#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "server/prepare/perceptual.h"
#include "server/progress/progress.h"

namespace tessera {

/// A texel of the photograph.
struct PhotoPoint {
    std::int32_t x = 0, y = 0;
    bool operator==(const PhotoPoint&) const = default;
};

/// A periodic tile cut out of the photograph: each of its texels is one of the photograph's, unaltered.
struct PeriodicTile {
    std::int32_t side = 0;
    std::int32_t overlap = 0;         ///< Texels along which opposite sides were laid over each other.
    std::vector<PhotoPoint> sources;  ///< side×side: where each texel is from.
    std::uint64_t seam_cost =
        0;  ///< Summed color_distance()s of what was laid over each other, along the cuts.
};

/// The least overlap that a tile of `side` texels is cut with; the photograph is larger than the tile by it.
constexpr std::int32_t least_overlap(std::int32_t side) noexcept { return std::clamp(side / 8, 4, 64); }

/// Tries places all over the photograph, and takes the tile whose cuts show least. The photograph is at least
/// side + least_overlap(side) texels wide and high. Empty if it was stopped.
PeriodicTile make_tile(const PerceptualImage& photo, std::int32_t side, std::size_t threads,
                       Progress& progress);

Rgb8Image cut_out(const Rgb8Image& photo, const PeriodicTile& tile);

}  // namespace tessera
