#include "server/filter/float_line_sums.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/filter/line_table.h"
#include "shared/math/srgb.h"

namespace tessera {

namespace {

constexpr std::int32_t window = 4;

/// Four bright texels, then four dark ones of different shades.
std::uint16_t texel(std::int32_t at) noexcept {
    constexpr std::array<std::uint8_t, 4> dark{2, 5, 11, 20};
    return srgb_to_steps[at % 8 < 4 ? std::uint8_t{255} : dark[static_cast<std::size_t>(at % 4)]];
}

double truth(std::int32_t first) noexcept {
    double sum = 0;
    for (std::int32_t i = first; i < first + window; ++i) sum += texel(i);
    return sum / window;
}

}  // namespace

double float_line_error(std::int32_t length) {
    std::array<float, window + 1> sums{};  // Before each of the last texels
    double furthest = 0;
    for (std::int32_t i = 0; i < length; ++i) {
        std::rotate(sums.begin(), sums.begin() + 1, sums.end());
        sums[window] = sums[window - 1] + static_cast<float>(texel(i)) / linear_one;
        if (i + 1 < window || i + 4096 < length) continue;  // The end of the line
        const double average = static_cast<double>((sums[window] - sums[0]) / window);
        furthest = std::max(furthest, std::fabs(average - truth(i + 1 - window) / double{linear_one}) * 255);
    }
    return furthest;
}

double integer_line_error(std::int32_t length) {
    const std::int32_t page_first = (length - 1) / page_side_texels * page_side_texels;
    TexelPage page;
    page.steps.resize(std::size_t{4} * page_side_texels * page_side_texels);
    for (std::int32_t y = 0; y < page_side_texels; ++y)
        std::fill_n(page.steps.begin() + std::ptrdiff_t{4} * page_side_texels * y, 4 * page_side_texels,
                    texel(page_first + y));
    const LineTable<false> table{page};
    double furthest = 0;
    for (std::int32_t y = 0; y + window <= std::min(length, page_side_texels); ++y) {
        const double average =
            (table.mean_sum(0, y + window, y + window) - table.mean_sum(0, y, y))[0] / window;
        furthest = std::max(furthest, std::fabs(average - truth(page_first + y)) / double{linear_one} * 255);
    }
    return furthest;
}

}  // namespace tessera
