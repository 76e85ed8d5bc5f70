#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

/// Rows of yes and no for every texel.
class TexelBits {
  public:
    TexelBits(std::int32_t width, std::int32_t rows)
        : words_{std::size_t(width + 63) / 64}, bits_(words_ * std::size_t(rows)) {}

    std::size_t words() const noexcept { return words_; }
    std::uint64_t* row(std::int32_t row) noexcept { return bits_.data() + std::size_t(row) * words_; }
    void clear_row(std::int32_t index) noexcept { std::fill_n(row(index), words_, 0); }
    /// Sets [left, right) of a row, not empty.
    void set(std::int32_t index, std::int32_t left, std::int32_t right) noexcept {
        std::uint64_t* const words = row(index);
        for_words(left, right, [&](std::int32_t word, std::uint64_t bits) { words[word] |= bits; });
    }
    /// Calls `visit(word, bits)` for each word of a row that [left, right), not empty, has bits in.
    template <class Visit>
    static void for_words(std::int32_t left, std::int32_t right, const Visit& visit) {
        std::int32_t word = left / 64;
        const std::int32_t last = (right - 1) / 64;
        std::uint64_t bits = ~std::uint64_t{0} << left % 64;
        for (; word != last; bits = ~std::uint64_t{0}) visit(word++, bits);
        visit(last, bits & ~std::uint64_t{0} >> (63 - (right - 1) % 64));
    }

  private:
    std::size_t words_;
    std::vector<std::uint64_t> bits_;
};

/// Calls `visit(left, right)` for every run of set bits below `width`.
template <class Visit>
void for_runs(const std::uint64_t* words, std::int32_t width, const Visit& visit) {
    const auto find = [&](std::int32_t from, std::uint64_t flip) {
        for (; from < width; from = (from | 63) + 1)
            if (const std::uint64_t rest = (words[from / 64] ^ flip) >> from % 64; rest != 0)
                return std::min(width, from + std::countr_zero(rest));
        return width;
    };
    for (std::int32_t left = find(0, 0); left < width;) {
        const std::int32_t right = find(left, ~std::uint64_t{0});
        visit(left, right);
        left = find(right, 0);
    }
}

}  // namespace tessera
