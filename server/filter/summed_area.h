#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

/// Sums over boxes of an image of four channels of 16-bit steps, each with a handful of reads (Crow,
/// "Summed-area tables for texture mapping", SIGGRAPH 1984). Integers, and therefore exact and the same
/// wherever a box lies. Entries are kept modulo 2^32: a box of at most 256·256 texels sums to at most
/// 2^16·(2^16 − 1) < 2^32, so its difference of four entries is its sum; larger boxes are sums of such boxes.
class SummedArea {
  public:
    using Sums = std::array<std::uint64_t, 4>;

    SummedArea() = default;

    /// All transparent black. Sides 1 to 32768.
    SummedArea(std::int32_t width, std::int32_t height)
        : width_{width}, height_{height}, entries_(entries_of(width, height)) {}

    /// The next row, in order from the top, 4·width steps: called once for each row.
    void set_row(std::int32_t y, const std::uint16_t* steps) noexcept {
        const std::uint32_t* above = line(y) + 4;
        std::uint32_t* below = entries_.data() + (line(y + 1) - line(0)) + 4;
        std::array<std::uint32_t, 4> row{};
        for (std::int32_t x = 0; x < width_; ++x, above += 4, below += 4, steps += 4)
            for (std::size_t c = 0; c < 4; ++c) {
                row[c] += steps[c];
                below[c] = above[c] + row[c];
            }
    }

    std::int32_t width() const noexcept { return width_; }
    std::int32_t height() const noexcept { return height_; }

    /// Of texels [x0, x1) × [y0, y1), inside the image.
    Sums sum(std::int32_t x0, std::int32_t y0, std::int32_t x1, std::int32_t y1) const noexcept {
        Sums total{};
        for (std::int32_t y = y0; y < y1; y += 256)
            for (std::int32_t x = x0; x < x1; x += 256) {
                const std::int32_t right = std::min(x + 256, x1);
                const std::uint32_t* upper = line(y);
                const std::uint32_t* lower = line(std::min(y + 256, y1));
                for (std::size_t c = 0; c < 4; ++c) total[c] += small(upper, lower, x, right, c);
            }
        return total;
    }

    /// Entries above texel row `y` (0 to height): 4 for each column from 0 to width.
    const std::uint32_t* line(std::int32_t y) const noexcept {
        return entries_.data() + static_cast<std::size_t>(y) * 4 * (static_cast<std::size_t>(width_) + 1);
    }
    /// Channel `c` of a box of at most 65,536 texels between two lines.
    static std::uint32_t small(const std::uint32_t* upper, const std::uint32_t* lower, std::int32_t x0,
                               std::int32_t x1, std::size_t c) noexcept {
        const std::size_t from = static_cast<std::size_t>(x0) * 4 + c,
                          to = static_cast<std::size_t>(x1) * 4 + c;
        return (lower[to] - lower[from]) - (upper[to] - upper[from]);
    }

    static constexpr std::size_t bytes(std::int32_t width, std::int32_t height) noexcept {
        return entries_of(width, height) * sizeof(std::uint32_t);
    }
    std::size_t memory_bytes() const noexcept { return entries_.size() * sizeof(std::uint32_t); }

  private:
    static constexpr std::size_t entries_of(std::int32_t width, std::int32_t height) noexcept {
        return 4 * (static_cast<std::size_t>(width) + 1) * (static_cast<std::size_t>(height) + 1);
    }

    std::int32_t width_ = 0, height_ = 0;
    std::vector<std::uint32_t>
        entries_;  ///< Of all texels above and left; a row and a column of zeros first.
};

}  // namespace tessera
