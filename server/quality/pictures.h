#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/quality/measures.h"
#include "shared/page/texel_image.h"

namespace tessera {

/// A colour for a value of 0 to 1, from dark to bright, as the eye orders them.
std::array<std::uint8_t, 3> heat(double value) noexcept;

/// The periodic tile at a level, filtered in linear light; repeated until it is at least `least_side` texels
/// wide.
Rgba8Image tile_at_level(const Rgb8Image& tile, int level, std::int32_t least_side = 1);

/// content_exchange: the tile, each patch in a colour with its number.
Rgba8Image draw_patch_map(const ExchangeAsset& asset);

/// How many contents cover each texel of the tile, against the most: brighter is more.
struct Coverage {
    Rgba8Image image;
    std::int32_t greatest = 0;
};
Coverage draw_coverage(const ExchangeAsset& asset);

/// Where over the tile seams lie, and what they cost: `full_scale` times the exemplar's mean step and more is
/// brightest.
inline constexpr double seam_full_scale = 3;
Rgba8Image draw_seam_energy(const ExchangeAsset& asset, const Seams& seams);

/// A texel for each cell, the brightest for 1.
Rgba8Image draw_cells(const TileShare::Figure& figure, std::int32_t cells_a_side);

/// Greys as light as Repetition::mean_lightness.
Rgba8Image draw_mean_tile(const Repetition& repetition);

/// A content by itself: what it costs, and how it looks.
struct ContentFacts {
    std::size_t patch = 0;
    std::size_t content = 0;  ///< In the order listed, from 1.
    std::int32_t texels = 0;  ///< Of its shape.
    double seam_ratio =
        0;  ///< Mean step from its shape's texels to the tile around, against the exemplar's mean step.
    std::size_t sheet = 0;  ///< Which picture shows it, and where.
    std::int32_t x = 0, y = 0;
};
struct ContentSheets {
    std::int32_t thumbnail_side = 0;
    std::vector<Rgba8Image> sheets;
    std::vector<ContentFacts> contents;
    std::size_t left_out = 0;  ///< Beyond what a report shows.
};
/// Every content with the tile around it, dimmed. Error: cancelled.
Result<ContentSheets> draw_contents(const ExchangeAsset& asset, double exemplar_step,
                                    const ProgressPart& progress);

}  // namespace tessera
