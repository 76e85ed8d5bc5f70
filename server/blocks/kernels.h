#pragma once

#include <cstddef>
#include <cstdint>

#include "server/blocks/row_hash.h"

namespace tessera {

/// The inner loops over cells, compiled once for each instruction set from kernels_body.inc. Integers only:
/// all give the same.
struct BlockKernels {
    /// Draws below `count` (1 to 65536) for cells x, x + 1, … of the row that `key` is of; x + cells at most
    /// 2^row_log2. The draw is ⌊bits·count / 2^32⌋, and drawn again where that would favour some (Lemire).
    void (*draw)(RowKey key, std::uint32_t x, std::int32_t cells, std::uint32_t count, std::int32_t* out);

    /// Cells between the same four nodes of a dithered map, from column `column` of 2^cells_log2 on.
    struct DitherRun {
        RowKey key;
        std::uint32_t x;  ///< As for draw.
        std::int32_t cells;
        int cells_log2;         ///< 1 to 16.
        std::uint32_t column;   ///< The first cell's, from the left nodes.
        std::uint32_t down;     ///< Jitters from this on, in 2^-16 of the nodes' distance, move down.
        std::int32_t nodes[4];  ///< Top-left, top-right, bottom-left, bottom-right.
    };
    void (*dither)(const DitherRun& run, std::int32_t* out);
    /// The same where nodes are so close that runs would be short. `nodes`: the row of nodes above, from the
    /// one left of the first cell on, and `below` integers further the row below.
    void (*dither_close)(const DitherRun& run, const std::int32_t* nodes, std::int32_t below,
                         std::int32_t* out);

    /// Nested thresholds: one more digit for each of the cells x, x + 1, … `first` and `second` are the keys
    /// of their nodes, `down` is 2 in the lower quadrants, `right_log2` the bit of x that tells right from
    /// left.
    void (*nest)(const std::uint32_t* first, const std::uint32_t* second, std::uint32_t x, int right_log2,
                 std::uint32_t down, std::int32_t cells, std::uint32_t* digits);

    /// Nested thresholds against the four weights of the nodes around a cell: all in one row of cells.
    struct NestedRun {
        std::int32_t cells;
        int cells_log2;       ///< 1 to 16.
        std::int32_t column;  ///< The first cell's, from the node left of it.
        std::int32_t row;     ///< Of all of them, from the nodes above.
        bool across;          ///< Whether the map is dithered along x.
    };
    /// `nodes`, `below`: as for dither_close.
    void (*dither_nested)(const NestedRun& run, const std::uint32_t* thresholds, const std::int32_t* nodes,
                          std::int32_t below, std::int32_t* out);

    /// `size`: of `table`; small ones are faster.
    void (*look_up)(const std::int32_t* table, std::int32_t size, const std::int32_t* in, std::int32_t cells,
                    std::int32_t* out);
    void (*look_up_types)(const std::int32_t* table, const std::uint16_t* types, std::int32_t cells,
                          std::int32_t* out);
    /// out = table[row·stride + column]
    void (*look_up_pairs)(const std::int32_t* table, std::int32_t size, std::int32_t stride,
                          const std::int32_t* row, const std::int32_t* column, std::int32_t cells,
                          std::int32_t* out);
    /// Texels of four bytes: out = codes[image]. There are `count` of them, from number `least` on.
    void (*copy_texels)(const unsigned char* codes, std::int32_t least, std::int32_t count,
                        const std::int32_t* images, std::int32_t cells, unsigned char* out);
    /// out = c0 | c1 << bits | c2 << 2·bits | c3 << 3·bits
    void (*join_corners)(const std::int32_t* const* corners, int bits, std::int32_t cells, std::int32_t* out);
    /// Adds to each of `sums` integers, four by four, those that the next `run` cells' indices name in
    /// `table`.
    void (*add_colours)(const std::int64_t* table, const std::int32_t* indices, std::int32_t run,
                        std::int32_t sums, std::int64_t* out);
    /// out = sums / unit, rounded to double, then to float.
    void (*divide)(const std::int64_t* sums, double unit, std::int32_t count, float* out);
};

/// The best that this processor runs; `TESSERA_KERNELS=x86-64|avx2|avx512` in the environment asks for less.
const BlockKernels& block_kernels() noexcept;

/// By name; null if this processor does not run it.
const BlockKernels* block_kernels_of(const char* name) noexcept;

}  // namespace tessera
