#pragma once

#include <cstdint>

#include "shared/math/hash.h"

namespace tessera {

/// The counter hash of `independent` draws, shaped so that eight or sixteen cells are hashed at once: 32-bit
/// operations only, and all that a row of cells shares is hashed beforehand, in 64 bits.
struct RowKey {
    std::uint64_t whole = 0;

    std::uint32_t first() const noexcept { return static_cast<std::uint32_t>(whole); }
    std::uint32_t second() const noexcept { return static_cast<std::uint32_t>(whole >> 32); }
};

/// A row's key changes every 2^16 cells.
inline constexpr int row_log2 = 16;

/// What all rows of a stream share.
constexpr std::uint64_t stream_base(std::uint64_t seed, std::uint64_t stream_key) noexcept {
    return mix(seed ^ stream_key);
}

constexpr RowKey row_key(std::uint64_t base, std::int64_t x, std::int64_t y, std::int64_t z) noexcept {
    std::uint64_t key = mix(base + 0x9e3779b97f4a7c15u * static_cast<std::uint64_t>(y));
    key = mix(key ^ (0xd1342543de82ef95u * static_cast<std::uint64_t>(x >> row_log2) + 0x632be59bd9b4e019u));
    return {mix(key ^ (0xa0761d6478bd642fu * static_cast<std::uint64_t>(z) + 0xe7037ed1a0b428dbu))};
}

/// 32 random bits for the cell at `x` mod 2^16 of the row. The mixer is `triple32` of Wellons ("Hash function
/// prospector", 2018, in the public domain), with the row's key before and in the midst of it: rows are
/// different permutations, and not one sequence shifted.
constexpr std::uint32_t cell_bits(std::uint32_t x, std::uint32_t first, std::uint32_t second) noexcept {
    std::uint32_t h = x ^ first;
    h ^= h >> 17;
    h *= 0xed5ad4bbu;
    h ^= h >> 11;
    h += second;
    h *= 0xac4c1b51u;
    h ^= h >> 15;
    h *= 0x31848babu;
    return h ^ (h >> 14);
}

/// The draw below `count` where cell_bits() would favour some: for so few cells that only fairness counts.
std::uint32_t redraw(RowKey key, std::uint32_t x, std::uint32_t count) noexcept;

}  // namespace tessera
