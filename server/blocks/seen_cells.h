#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "server/blocks/cell_program.h"

namespace tessera {

/// What a block of cells that scroll shows, as far as that tells how long it does: one look everywhere, or
/// where two differ. Rows are told as they come.
class SeenCells {
  public:
    /// A place, and what it shows.
    struct Odd {
        std::int64_t x = 0, y = 0;
        Look look;
    };

    /// `cells`: that they scroll from shift to shift.
    explicit SeenCells(std::int64_t cells) noexcept : cells_{std::abs(cells)} {}

    void see(std::int64_t x, std::int64_t y, std::span<const std::int32_t> patterns) {
        add(x, y, patterns, true);
    }
    void see(std::int64_t x, std::int64_t y, std::span<const Look> looks) { add(x, y, looks, false); }

    bool empty() const noexcept { return empty_; }
    bool alike() const noexcept { return alike_; }
    bool only_patterns() const noexcept { return only_patterns_; }  ///< Of looks, these were told.
    const Look& look() const noexcept { return look_; }             ///< The first.

    /// Not alike: a place in a row that shows something else than the others. Where differs_shifted(), two,
    /// as far from each other as cells scroll.
    const Odd& first() const noexcept { return first_; }
    const Odd& second() const noexcept { return second_; }
    bool differs_shifted() const noexcept { return differs_shifted_; }

  private:
    static bool alike(std::int32_t a, std::int32_t b) noexcept { return a == b; }
    static bool alike(const Look& a, const Look& b) noexcept { return shows_same(a, b); }
    static Look look_of(std::int32_t pattern) noexcept { return {.pattern = pattern}; }
    static const Look& look_of(const Look& look) noexcept { return look; }

    template <class Cell>
    void add(std::int64_t x, std::int64_t y, std::span<const Cell> row, bool only_patterns) {
        if (!alike_ || row.empty()) return;
        const auto same = [](const Cell& a, const Cell& b) { return alike(a, b); };
        if (empty_) look_ = look_of(row.front());
        empty_ = false;
        only_patterns_ = only_patterns;
        if (alike(look_of(row.front()), look_) &&
            std::equal(row.begin(), row.end() - 1, row.begin() + 1, same))
            return;
        alike_ = false;
        const auto odd = [&](std::size_t i) {
            return Odd{x + static_cast<std::int64_t>(i), y, look_of(row[i])};
        };
        first_ = odd(0);
        if (cells_ >= std::ssize(row)) return;
        const auto [at, further] = std::mismatch(row.begin(), row.end() - cells_, row.begin() + cells_, same);
        if (further == row.end()) return;
        differs_shifted_ = true;
        first_ = odd(static_cast<std::size_t>(at - row.begin()));
        second_ = odd(static_cast<std::size_t>(further - row.begin()));
    }

    std::int64_t cells_;
    bool empty_ = true, alike_ = true, only_patterns_ = false, differs_shifted_ = false;
    Look look_;
    Odd first_, second_;
};

}  // namespace tessera
