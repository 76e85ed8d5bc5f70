#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/texture/exchange_asset.h"

namespace tessera {

/// Which texels of a unit and of what hangs over it are taken: rows of 64-bit words, one word more than
/// needed.
class PackedGround {
  public:
    PackedGround(std::int32_t width, std::int32_t height)
        : words_(std::size_t(width) / 64 + 2), bits_(words_ * std::size_t(height)) {}

    void take(std::int32_t x, std::int32_t y) noexcept {
        bits_[std::size_t(y) * words_ + std::size_t(x) / 64] |= std::uint64_t{1} << x % 64;
    }
    std::uint64_t* row(std::int32_t y) noexcept { return bits_.data() + std::size_t(y) * words_; }
    const std::uint64_t* row(std::int32_t y) const noexcept { return bits_.data() + std::size_t(y) * words_; }

  private:
    std::size_t words_;
    std::vector<std::uint64_t> bits_;
};

/// Texels without blending, ready to be laid on the ground.
struct PackedPiece {
    std::int32_t words = 0;  ///< A row's.
    std::int32_t height = 0;
    std::vector<std::uint64_t> bits;
    std::int32_t texels = 0;

    PackedPiece(std::int32_t width, std::int32_t rows)
        : words{(width + 63) / 64}, height{rows}, bits(std::size_t(words) * std::size_t(rows)) {}

    /// Adds the shape's texels, its first one at (left, top); none of them is there already.
    void add(const BitMask& shape, std::int32_t left, std::int32_t top) {
        for (std::int32_t y = 0; y < shape.height; ++y)
            for (std::int32_t x = 0; x < shape.width; ++x)
                if (shape.at(x, y)) {
                    bits[std::size_t((top + y) * words + (left + x) / 64)] |= std::uint64_t{1}
                                                                              << (left + x) % 64;
                    ++texels;
                }
    }
};

/// Whether the piece lies on free ground only. Begins with the middle, where it is widest.
inline bool fits(const PackedPiece& piece, std::int32_t x, std::int32_t y, const PackedGround& ground) {
    const int shift = x % 64;
    for (std::int32_t i = 0, row = piece.height / 2; i < piece.height; ++i, ++row) {
        if (row == piece.height) row = 0;
        const std::uint64_t* from = piece.bits.data() + std::ptrdiff_t{row} * piece.words;
        const std::uint64_t* to = ground.row(y + row) + x / 64;
        for (std::int32_t w = 0; w < piece.words; ++w) {
            if ((from[w] << shift & to[w]) != 0) return false;
            if (shift > 0 && (from[w] >> (64 - shift) & to[w + 1]) != 0) return false;
        }
    }
    return true;
}

inline void lay(const PackedPiece& piece, std::int32_t x, std::int32_t y, PackedGround& ground) {
    const int shift = x % 64;
    for (std::int32_t row = 0; row < piece.height; ++row) {
        const std::uint64_t* from = piece.bits.data() + std::ptrdiff_t{row} * piece.words;
        std::uint64_t* to = ground.row(y + row) + x / 64;
        for (std::int32_t w = 0; w < piece.words; ++w) {
            to[w] |= from[w] << shift;
            if (shift > 0) to[w + 1] |= from[w] >> (64 - shift);
        }
    }
}

}  // namespace tessera
