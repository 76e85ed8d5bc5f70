#pragma once

#include <cstdint>
#include <vector>

#include "server/prepare/patches.h"
#include "server/prepare/perceptual.h"

namespace tessera {

/// The texels on both sides of a patch's border, as the tile shows them, at a resolution reduced by `factor`.
/// A content fits if the photograph, moved by it, shows the same there.
struct BorderBand {
    struct Texel {
        std::int32_t x = 0, y = 0;  ///< In reduced texels, from the band's own corner.
        PerceptualColor color;
    };
    std::int32_t factor = 1;
    std::int32_t margin =
        0;  ///< Full texels from the band's corner to the patch's origin: a multiple of factor.
    std::int32_t width = 0, height = 0;  ///< In reduced texels.
    std::vector<Texel> texels;
};

/// `reach`: how far the band goes to each side of the border, in full texels.
BorderBand make_border_band(const PerceptualImage& tile, const Segmentation& segmentation, std::size_t patch,
                            std::int32_t reach, std::int32_t factor);

/// Where the patch's origin may lie in the photograph so that the band at `factor` is inside: first and last,
/// in steps of factor. Nowhere if last < first.
struct Span {
    std::int32_t first = 0, last = -1;
};
Span span_of(std::int32_t photo_side, std::int32_t band_side, const BorderBand& band);

/// The band's mean difference from the photograph, reduced by the same factor, with the patch's origin at
/// (x, y), which is inside both spans and on their steps.
std::uint64_t mean_difference(const BorderBand& band, const PerceptualImage& reduced_photo, std::int32_t x,
                              std::int32_t y);

/// The same for every place of the photograph at once: rows of spans, row by row.
std::vector<std::uint32_t> all_differences(const BorderBand& band, const PerceptualImage& reduced_photo);

}  // namespace tessera
