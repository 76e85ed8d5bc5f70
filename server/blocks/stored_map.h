#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/blocks/map_values.h"

namespace tessera {

/// An explicit map: integers on a rectangle of cells, and what is outside it.
struct StoredMap {
    enum class Edge : std::uint8_t { wrap, clamp, blank };

    std::int32_t width = 0;   ///< In entries, 1 to 32768.
    std::int32_t height = 0;  ///< In entries, 1 to 32768; width·height at most 2^26.
    MapValues values;         ///< Rows from the top. −1: blank.
    Edge edge = Edge::wrap;
    int cells_log2 = 0;  ///< An entry covers 2^cells_log2 cells along a side; 0 to 16.
    std::int64_t x = 0;  ///< The cell of the first entry's top-left corner: a multiple of 2^cells_log2.
    std::int64_t y = 0;
    /// Where edits may change entries: from what to what. Whatever is worked out for the whole map, from then
    /// on, is worked out for all of these, so that an edit changes nothing beyond the cells near it. Most
    /// below least: entries are what they are.
    std::int32_t least = 0, most = -1;

    bool bounded() const noexcept { return least <= most; }

    /// Into 0 to `side` − 1. Mostly it lies there, and a division takes long.
    static constexpr std::int64_t wrapped(std::int64_t i, std::int32_t side) noexcept {
        if (i >= 0 && i < side) return i;
        i %= side;
        return i < 0 ? i + side : i;
    }

    /// The entry (i, j), counted from the map's first one on; any integers.
    std::int32_t entry(std::int64_t i, std::int64_t j) const noexcept {
        if (edge == Edge::wrap) {
            i = wrapped(i, width);
            j = wrapped(j, height);
        } else if (edge == Edge::clamp) {
            i = std::clamp<std::int64_t>(i, 0, width - 1);
            j = std::clamp<std::int64_t>(j, 0, height - 1);
        } else if (i < 0 || j < 0 || i >= width || j >= height) {
            return -1;
        }
        return values[static_cast<std::size_t>(j * width + i)];
    }
};

/// The integers that the map shows somewhere, or may once it is edited, and −1 where it may be blank outside:
/// rising.
std::vector<std::int32_t> possible_values(const StoredMap& map);

}  // namespace tessera
