#pragma once

#include <cstdint>
#include <vector>

#include "server/filter/four.h"
#include "server/filter/texel_pages.h"

namespace tessera {

/// The line integral texture of a page (section 3.2 of line-integral-textures): for each line of texels, the
/// sums of all texels before a place, and the sums of those sums, with which a line's average over a slanted
/// edge takes two reads however steep the edge is. Integers: 256 steps of 16 bits sum to less than 2^24,
/// their sums to less than 2^31, so nothing is rounded wherever a page lies, and a line of many pages is a
/// line of exact sums.
///
/// A line is a column, and a place counts texels from its top; or a row, counted from the left. Sums are kept
/// for every fourth place, with the four texels that follow: one cache line holds all that a place needs, and
/// one page of memory those of eight lines side by side.
template <bool Horizontal>
class LineTable {
  public:
    static constexpr std::size_t block_texels = 4, tile_side = 8;
    struct Block {
        std::int32_t sums_before[4];             ///< Of `before` at all earlier places.
        std::int32_t before[4];                  ///< Of all earlier texels.
        std::uint16_t texels[block_texels * 4];  ///< From here on.
    };
    struct alignas(4096) Tile {
        Block blocks[tile_side][tile_side];  ///< [line][place / 4]
    };
    static constexpr std::size_t bytes = sizeof(Block) * page_side_texels * page_side_texels / block_texels;

    explicit LineTable(const TexelPage& page) : tiles_(bytes / sizeof(Tile)) {
        constexpr std::size_t side = page_side_texels;
        for (std::size_t line = 0; line < side; ++line) {
            const std::uint16_t* texel = page.steps.data() + 4 * (Horizontal ? line * side : line);
            Ints4 sums{}, sum{};
            for (std::size_t place = 0; place < side; ++place, texel += Horizontal ? 4 : 4 * side) {
                const std::size_t in_block = place % block_texels;
                Block& to = tiles_[tile(line, place / block_texels)]
                                .blocks[line % tile_side][place / block_texels % tile_side];
                if (in_block == 0) {
                    std::memcpy(to.sums_before, &sums, sizeof sums);
                    std::memcpy(to.before, &sum, sizeof sum);
                }
                std::memcpy(to.texels + 4 * in_block, texel, 4 * sizeof *texel);
                sums += sum;
                sum += load_steps(texel);
            }
        }
    }

    /// The average, over the places from `from` to `to` (0 to 256, either way round), of the sum S of all of
    /// a line's texels before the place, where a part of a texel counts as that part.
    Doubles4 mean_sum(std::size_t line, double from, double to) const noexcept {
        const double low = from < to ? from : to, high = from < to ? to : from;
        const std::int32_t first = texel_at(low), last = texel_at(high);
        const Block& a = block(line, static_cast<std::size_t>(first) / block_texels);
        const auto in_a = static_cast<std::size_t>(first) % block_texels;
        const Sums sums_a{a};
        const Ints4 texel_a = load_steps(a.texels + 4 * in_a);
        if (first == last)  // S is linear inside a texel
            return Doubles4{sums_a.before[in_a]} + Doubles4{texel_a} * ((low + high) / 2 - first);

        // Trapezoids: what is left of the first texel, whole texels, what is cut of the last
        const Block& b = block(line, static_cast<std::size_t>(last) / block_texels);
        const auto in_b = static_cast<std::size_t>(last) % block_texels;
        const Sums sums_b{b};
        const Ints4 texel_b = load_steps(b.texels + 4 * in_b);
        const Ints4 before_a = sums_a.before[in_a + 1], before_b = sums_b.before[in_b];
        const double left = first + 1 - low, cut = high - last;
        // Sums of sums from the end of the first texel to the beginning of the last: an integer
        const Ints4 some = load_ints(b.sums_before) - load_ints(a.sums_before) + sums_b.sums_in_block(in_b) -
                           sums_a.sums_in_block(in_a + 1);
        Doubles4 sum = Doubles4{some} + Doubles4{sums_b.before[0]} * static_cast<double>(in_b) -
                       Doubles4{sums_a.before[0]} * static_cast<double>(in_a + 1);
        sum += Doubles4{before_b} * (cut + 0.5) + Doubles4{before_a} * (left - 0.5);
        sum += Doubles4{texel_b} * (cut * cut / 2) - Doubles4{texel_a} * (left * left / 2);
        return sum * (1 / (high - low));
    }

  private:
    /// The sums before each texel of a block, and before its end.
    struct Sums {
        explicit Sums(const Block& block) noexcept {
            before[0] = load_ints(block.before);
            for (std::size_t i = 0; i < block_texels; ++i)
                before[i + 1] = before[i] + load_steps(block.texels + 4 * i);
        }
        /// Σ of before[i] − before[0], i < places.
        Ints4 sums_in_block(std::size_t places) const noexcept {
            const Ints4 one = before[1] - before[0], two = one + (before[2] - before[0]);
            const Ints4 sums[block_texels + 1] = {{}, {}, one, two, two + (before[3] - before[0])};
            return sums[places];
        }
        Ints4 before[block_texels + 1];
    };

    /// The texel at a place; the line's end belongs to the last one.
    static std::int32_t texel_at(double place) noexcept {
        const auto i = static_cast<std::int32_t>(place);
        return i < page_side_texels ? i : page_side_texels - 1;
    }

    static std::size_t tile(std::size_t line, std::size_t block) noexcept {
        constexpr std::size_t tiles_a_line = page_side_texels / block_texels / tile_side;
        return line / tile_side * tiles_a_line + block / tile_side;
    }
    const Block& block(std::size_t line, std::size_t number) const noexcept {
        return tiles_[tile(line, number)].blocks[line % tile_side][number % tile_side];
    }

    std::vector<Tile> tiles_;
};

}  // namespace tessera
