#pragma once

#include <bitset>
#include <cstdint>
#include <vector>

#include "server/blocks/stored_map.h"

namespace tessera {

/// A rectangle of a map's entries, counted from its first one on; any integers, as the map's edge says what
/// is beyond it.
struct EntryRectangle {
    std::int64_t x = 0, y = 0, width = 0, height = 0;
};

using Families = std::bitset<256>;

/// A map of families 0 to 254 that costs memory at their borders only: blocks of 16 × 16 entries of one
/// family are one number. Counts over large rectangles come from tables of the blocks, so that a texel of any
/// level knows exactly which share of it each family takes.
class SparseMap {
  public:
    /// `map.edge` is wrap or clamp; values are below `families`, 1 to 255.
    SparseMap(const StoredMap& map, std::size_t families);

    std::uint8_t at(std::int64_t x, std::int64_t y) const noexcept;

    /// Those that a rectangle shows; no more than all that the map holds.
    Families families_in(const EntryRectangle& rectangle) const;

    /// How many entries of `family` lie in each of columns × rows squares of 2^k entries a side, the first
    /// from (x·2^k, y·2^k) on, as shares of them: rows from the top. k is 1 to 30.
    std::vector<float> shares(std::uint8_t family, int k, std::int64_t x, std::int64_t y,
                              std::int32_t columns, std::int32_t rows) const;

    std::size_t memory_bytes() const noexcept;

  private:
    struct Cuts;
    Cuts cuts(std::int64_t start, std::int64_t side, std::int32_t count, std::int32_t size) const;
    std::int32_t inside(std::int64_t at, std::int32_t size) const noexcept;
    std::uint32_t count(std::uint8_t family, std::int32_t x0, std::int32_t y0, std::int32_t x1,
                        std::int32_t y1) const noexcept;
    std::uint32_t table(std::uint8_t family, std::int32_t table_x, std::int32_t table_y) const noexcept {
        return tables_[(std::size_t{family} * table_rows_ + static_cast<std::size_t>(table_y)) *
                           table_columns_ +
                       static_cast<std::size_t>(table_x)];
    }
    std::uint32_t block(std::int32_t x, std::int32_t y) const noexcept {
        return blocks_[static_cast<std::size_t>(y) * block_columns_ + static_cast<std::size_t>(x)];
    }

    std::int32_t width_, height_;
    bool wrap_;
    std::size_t block_columns_, block_rows_;
    std::vector<std::uint32_t> blocks_;  ///< Its family, or 256 and the number of its entries among mixed_.
    std::vector<std::uint8_t> mixed_;    ///< 256 for each block of several families, rows from the top.
    int table_log2_;  ///< Of entries between two lines of a table: 4, or 6 where families are many.
    std::size_t table_columns_, table_rows_;
    std::vector<std::uint32_t> tables_;  ///< [family]: how many lie above and left.
};

}  // namespace tessera
