#include "server/prepare/border_band.h"

#include <algorithm>

namespace tessera {
namespace {

/// A small grid of yes and no.
struct Mask {
    std::int32_t width = 0, height = 0;
    std::vector<std::uint8_t> cells;
    std::uint8_t& at(std::int32_t x, std::int32_t y) {
        return cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x)];
    }
    std::uint8_t at(std::int32_t x, std::int32_t y) const {
        return cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x)];
    }
};

/// Whether any cell within `reach` both ways is `value`.
Mask near(const Mask& mask, std::uint8_t value, std::int32_t reach) {
    Mask rows{mask.width, mask.height, std::vector<std::uint8_t>(mask.cells.size())}, out = rows;
    for (std::int32_t y = 0; y < mask.height; ++y)
        for (std::int32_t x = 0; x < mask.width; ++x)
            for (std::int32_t u = std::max(0, x - reach); u <= std::min(mask.width - 1, x + reach); ++u)
                rows.at(x, y) |= static_cast<std::uint8_t>(mask.at(u, y) == value);
    for (std::int32_t y = 0; y < mask.height; ++y)
        for (std::int32_t x = 0; x < mask.width; ++x)
            for (std::int32_t v = std::max(0, y - reach); v <= std::min(mask.height - 1, y + reach); ++v)
                out.at(x, y) |= rows.at(x, v);
    return out;
}

std::int32_t rounded_up(std::int32_t value, std::int32_t step) { return (value + step - 1) / step * step; }

}  // namespace

BorderBand make_border_band(const PerceptualImage& tile, const Segmentation& segmentation, std::size_t patch,
                            std::int32_t reach, std::int32_t factor) {
    const auto& box = segmentation.patches[patch];
    const std::int32_t wrap = tile.width - 1;
    BorderBand band;
    band.factor = factor;
    band.margin = rounded_up(reach, factor);
    const std::int32_t width = rounded_up(band.margin + box.width + reach, factor);
    const std::int32_t height = rounded_up(band.margin + box.height + reach, factor);
    band.width = width / factor;
    band.height = height / factor;

    // The patch alone, in a window that goes round the torus; a second turn is not the patch again
    Mask inside{
        width, height,
        std::vector<std::uint8_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
    for (std::int32_t y = 0; y < box.height; ++y)
        for (std::int32_t x = 0; x < box.width; ++x) {
            const std::int32_t texel = ((box.y + y) & wrap) * tile.width + ((box.x + x) & wrap);
            inside.at(band.margin + x, band.margin + y) =
                segmentation.labels[static_cast<std::size_t>(texel)] == patch;
        }
    const Mask around = near(inside, 1, reach);
    const Mask border = near(inside, 0, reach);

    // A reduced texel counts if half of it is in the band, so that its mean speaks for the band
    for (std::int32_t least = factor * factor / 2; band.texels.empty(); least = 0)
        for (std::int32_t y = 0; y < band.height; ++y)
            for (std::int32_t x = 0; x < band.width; ++x) {
                std::int32_t count = 0, l = 0, g = 0, b = 0;
                for (std::int32_t v = y * factor; v < (y + 1) * factor; ++v)
                    for (std::int32_t u = x * factor; u < (x + 1) * factor; ++u) {
                        count += around.at(u, v) & border.at(u, v);
                        const PerceptualColor& color =
                            tile.at((box.x + u - band.margin) & wrap, (box.y + v - band.margin) & wrap);
                        l += color.lightness;
                        g += color.green_red;
                        b += color.blue_yellow;
                    }
                const std::int32_t texels = factor * factor;
                if (count > 0 && count >= least)
                    band.texels.push_back(
                        {x,
                         y,
                         {static_cast<std::int16_t>(l / texels), static_cast<std::int16_t>(g / texels),
                          static_cast<std::int16_t>(b / texels)}});
            }
    return band;
}

Span span_of(std::int32_t photo_side, std::int32_t band_side, const BorderBand& band) {
    return {band.margin, band.margin + (photo_side / band.factor - band_side) * band.factor};
}

std::uint64_t mean_difference(const BorderBand& band, const PerceptualImage& reduced_photo, std::int32_t x,
                              std::int32_t y) {
    const std::int32_t left = (x - band.margin) / band.factor;
    const std::int32_t top = (y - band.margin) / band.factor;
    std::uint64_t sum = 0;
    for (const BorderBand::Texel& texel : band.texels)
        sum += static_cast<std::uint64_t>(
            difference(texel.color, reduced_photo.at(left + texel.x, top + texel.y)));
    return sum / band.texels.size();
}

std::vector<std::uint32_t> all_differences(const BorderBand& band, const PerceptualImage& reduced_photo) {
    const std::int32_t columns = reduced_photo.width - band.width + 1;
    const std::int32_t rows = reduced_photo.height - band.height + 1;
    std::vector<std::uint32_t> sums;
    if (columns < 1 || rows < 1) return sums;
    sums.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    // Sixteenths of a difference, of at most 4·10⁶, and at most 2^14 texels: no sum overflows 32 bits
    const std::size_t step = band.texels.size() / 8192 + 1;
    for (std::int32_t y = 0; y < rows; ++y) {
        std::uint32_t* row = sums.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(columns);
        for (std::size_t t = 0; t < band.texels.size(); t += step) {
            const BorderBand::Texel texel = band.texels[t];
            const PerceptualColor* photo = &reduced_photo.at(texel.x, y + texel.y);
            for (std::int32_t x = 0; x < columns; ++x)
                row[x] += static_cast<std::uint32_t>(difference(texel.color, photo[x])) >> 4;
        }
    }
    return sums;
}

}  // namespace tessera
