#pragma once

#include <cstdint>
#include <string_view>

namespace tessera {

/// Every decision is drawn from a counter-based integer hash: the same arguments give the same bits on every
/// machine, in any order, without state. A *stream* names what is decided ("contents of patch 7"), so that
/// adding a block never shifts another block's randomness.

/// A bijection of 64 bits whose output bits each depend on every input bit (Steele, Lea, Flood,
/// "Fast splittable pseudorandom number generators", OOPSLA 2014: the finaliser of SplitMix, variant 13).
constexpr std::uint64_t mix(std::uint64_t z) noexcept {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/// The key of a named stream; `index` tells apart streams of one kind, such as one per patch.
constexpr std::uint64_t stream(std::string_view name, std::uint64_t index = 0) noexcept {
    std::uint64_t h = 0xcbf29ce484222325u;  // FNV-1a over the name, then mixed
    for (const char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return mix(h + 0x9e3779b97f4a7c15u * (index + 1));
}

/// 64 random bits for the lattice point (x, y) in a stream.
constexpr std::uint64_t hash(std::uint64_t seed, std::uint64_t stream_key, std::int64_t x,
                             std::int64_t y) noexcept {
    std::uint64_t h = mix(seed ^ stream_key);
    h = mix(h + 0x9e3779b97f4a7c15u * static_cast<std::uint64_t>(x));
    return mix(h ^ (0xd1342543de82ef95u * static_cast<std::uint64_t>(y) + 0x632be59bd9b4e019u));
}

/// Uniform in [0, count), without bias: a rejected draw is hashed again (Lemire, "Fast random integer
/// generation in an interval", ACM TOMACS 29(1), 2019). `count` is at least 1.
constexpr std::uint32_t uniform_below(std::uint64_t bits, std::uint32_t count) noexcept {
    for (;;) {
        const std::uint64_t product = (bits >> 32) * count;
        const auto low = static_cast<std::uint32_t>(product);
        if (low >= count || low >= (0u - count) % count) return static_cast<std::uint32_t>(product >> 32);
        bits = mix(bits + 0x9e3779b97f4a7c15u);
    }
}

}  // namespace tessera
