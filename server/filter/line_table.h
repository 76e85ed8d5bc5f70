#pragma once

#include <cstdint>
#include <vector>

#include "server/filter/four.h"
#include "server/filter/texel_pages.h"

namespace tessera {

/// The line integral texture of a page (section 3.2 of line-integral-textures): for each line of texels, the
/// sums of all texels before a place, and the sums of those sums, with which a line's average over a slanted
/// edge is a handful of reads however steep the edge is. Integers: 256 steps of 16 bits sum to less than
/// 2^24, their sums to less than 2^31, so nothing is rounded wherever a page lies, and a line of many pages
/// is a line of exact sums. The sums along a line lie beside each other in memory.
///
/// A line is a column, and a place counts texels from its top; or a row, counted from the left.
template <bool Horizontal>
class LineTable {
  public:
    struct Entry {
        std::int32_t sums_before[4];  ///< Of `before` at all earlier places.
        std::int32_t before[4];       ///< Of all earlier texels.
    };
    static constexpr std::size_t places = page_side_texels + 1;
    static constexpr std::size_t bytes = sizeof(Entry) * page_side_texels * places;

    explicit LineTable(const TexelPage& page) : entries_(page_side_texels * places) {
        constexpr std::size_t side = page_side_texels;
        for (std::size_t line = 0; line < side; ++line) {
            Entry* entry = entries_.data() + line * places;
            const std::uint16_t* texel = page.steps.data() + 4 * (Horizontal ? line * side : line);
            for (std::size_t i = 0; i < side; ++i, texel += Horizontal ? 4 : 4 * side)
                for (std::size_t c = 0; c < 4; ++c) {
                    entry[i + 1].sums_before[c] = entry[i].sums_before[c] + entry[i].before[c];
                    entry[i + 1].before[c] = entry[i].before[c] + texel[c];
                }
        }
    }

    /// The average over the places from `from` to `to` (0 to 256, either way round) of the sum of all of a
    /// line's texels before the place, where a part of a texel counts as that part: S(to) averaged over an
    /// edge. S is linear inside a texel, so its average there is its value in the middle.
    Doubles4 mean_sum(std::int64_t line, double from, double to) const noexcept {
        const double low = from < to ? from : to, high = from < to ? to : from;
        const Entry* entries = entries_.data() + static_cast<std::size_t>(line) * places;
        const auto first = whole(low), last = whole(high);
        const Entry& a = entries[first];
        const Ints4 a0 = load_ints(a.before), a1 = load_ints(entries[first + 1].before);
        if (first == last)
            return Doubles4{a0} + Doubles4{a1 - a0} * ((low + high) / 2 - static_cast<double>(first));

        // Trapezoids: of what is left of the first texel, of whole texels, of what is cut of the last
        const Entry& b = entries[last];
        const Ints4 b0 = load_ints(b.before), b1 = load_ints(entries[last + 1].before);
        const double left = static_cast<double>(first + 1) - low, cut = high - static_cast<double>(last);
        const Ints4 between = load_ints(b.sums_before) - load_ints(entries[first + 1].sums_before);
        Doubles4 sum = Doubles4{between} + Doubles4{b0 - a1} * 0.5;
        sum += Doubles4{a1} * left - Doubles4{a1 - a0} * (left * left / 2);
        sum += Doubles4{b0} * cut + Doubles4{b1 - b0} * (cut * cut / 2);
        return sum * (1 / (high - low));
    }

  private:
    /// The texel at a place; the last one's end belongs to it.
    static std::int32_t whole(double place) noexcept {
        const auto i = static_cast<std::int32_t>(place);
        return i < page_side_texels ? i : page_side_texels - 1;
    }

    std::vector<Entry> entries_;  ///< [line][place]
};

}  // namespace tessera
