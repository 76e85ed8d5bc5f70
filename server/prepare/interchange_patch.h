#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/perceptual.h"
#include "server/prepare/quilting.h"
#include "server/texture/exchange_asset.h"

namespace tessera {

/// Where a patch is looked for: a square of the tile, which may reach over its border, and one of the
/// photograph.
struct PatchPlace {
    std::int32_t x = 0, y = 0;  ///< Its first texel relative to the tile.
    std::int32_t side = 0;
    std::int32_t core = 0;     ///< The side of the bell in its middle, at most `side`.
    ExchangeAsset::Offset at;  ///< The photograph's texel that lies on it.
    std::uint32_t pull = 0;    ///< What texels pay for lying on the wrong side.
};

/// A patch of the photograph that may lie on the tile. Its box fits its shape tightly.
struct InterchangePatch {
    std::int32_t x = 0, y = 0, width = 0, height = 0;
    ExchangeAsset::Offset at;
    BitMask shape;
    std::uint32_t worst = 0;  ///< The highest price along its border: what patches are ranked by.
    std::uint32_t mean = 0;   ///< The mean price along its border.
    std::uint32_t gradient =
        0;                    ///< The mean step from its texels to the tile's across the border: distance().
    std::int32_t texels = 0;  ///< In its shape.
    std::uint64_t cost =
        0;  ///< Of the cut, texels that pay included: the less, the better it fits the place.
    bool in_rhombus = true;  ///< Lies in the tile's rhombus as a whole.
};

/// Whether the tile's texel lies inside the rhombus |x − side/2| + |y − side/2| < side, texels by their
/// centres. The rhombi of diagonal neighbours share no texel, those of edge neighbours do.
constexpr bool in_rhombus(std::int32_t x, std::int32_t y, std::int32_t side) noexcept {
    const std::int32_t across = 2 * x + 1 - side, down = 2 * y + 1 - side;
    return (across < 0 ? -across : across) + (down < 0 ? -down : down) < 2 * side;
}

/// A Gaussian bell over a square, `side` texels wide, round its centre: 256 there, 128 at a radius of 3/8 of
/// the side.
std::int32_t bell(std::int32_t x, std::int32_t y, std::int32_t side) noexcept;

/// A mark for each texel of a square, in rows.
using SquareMarks = std::vector<std::uint8_t>;

/// The shape that the texels themselves suggest at a place, by minimum cut (Kolář et al. 2016, section 4.1).
/// Texels pay for lying outside where the bell is high, and for lying inside where it is low, so that the cut
/// closes round the centre at about the size that the bell asks for, and takes the way that shows least. (The
/// paper weighs the cuts themselves by the bell; then the cheapest cuts are those where the weight is least,
/// whatever they cut.) What is not `free` stays outside. The square lies in the photograph.
SquareMarks suggested_shape(const PerceptualImage& photo, const QuiltedTile& tile, const SquareMarks& free,
                            const PatchPlace& place);

/// Cuts a patch out of `region`, which holds the middle of the square and not its rim: the more of it the
/// better, most of all its depth, as far as the border does not show. One piece without holes. Without texels
/// if the region is empty.
InterchangePatch cut_patch(const PerceptualImage& photo, const QuiltedTile& tile, const SquareMarks& region,
                           const PatchPlace& place);

/// How many texels each marked texel lies inside the marks, in thirds (chamfer 3-4); 0 for others.
std::vector<std::int32_t> depths(const SquareMarks& marks, std::int32_t side);

}  // namespace tessera
