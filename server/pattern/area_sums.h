#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

/// A colour, or a difference of colours: linear, premultiplied.
using Colour = std::array<double, 4>;

/// Sums of colours over any rectangle of a lattice that goes on for ever, beyond its stored part by repeating
/// or by its outermost row and column: from a summed-area table of integers, so that no rectangle is too far
/// out or too large, and that equal colours sum to exactly so many times one.
class AreaSums {
  public:
    struct Axis {
        std::int64_t from = 0;  ///< What is stored: [from, from + count).
        std::int64_t count = 1;
        bool wraps = false;  ///< Else the first and the last go on.

        /// Where `at` is stored, from 0 on.
        std::int64_t stored(std::int64_t at) const noexcept {
            return wraps ? ((at - from) % count + count) % count
                         : std::clamp<std::int64_t>(at - from, 0, count - 1);
        }
    };

    /// `value(i, j)`: a colour, called once for each stored point, row after row. The magnitudes of all of
    /// them together are below 2^27.
    template <class Value>
    AreaSums(Axis x, Axis y, Value value) : x_{x}, y_{y}, sums_(std::size_t((x.count + 1) * (y.count + 1))) {
        for (std::int64_t j = 0; j < y.count; ++j) {
            std::array<std::int64_t, 4> row{};
            for (std::int64_t i = 0; i < x.count; ++i) {
                const Colour colour = value(x.from + i, y.from + j);
                for (std::size_t c = 0; c < 4; ++c) {
                    row[c] += in_units(colour[c]);
                    sums_[index(i + 1, j + 1)][c] = sums_[index(i + 1, j)][c] + row[c];
                }
            }
        }
    }

    /// A stretch of one axis: at most three stretches of what is stored, each so many times.
    struct Stretch {
        struct Part {
            std::int32_t from, to;  ///< Of what is stored, from 0 on.
            double times;
        };
        std::array<Part, 3> parts;
        std::int32_t count = 0;
    };
    Stretch columns(std::int64_t from, std::int64_t to) const noexcept { return stretch(x_, from, to); }
    Stretch rows(std::int64_t from, std::int64_t to) const noexcept { return stretch(y_, from, to); }

    Colour sum(const Stretch& columns, const Stretch& rows) const noexcept;

    std::size_t memory_bytes() const noexcept { return sums_.size() * sizeof sums_[0]; }

  private:
    /// 2^-35: 2^27 of them stay below 2^63.
    static constexpr double unit = 1.0 / 34359738368.0;
    static std::int64_t in_units(double value) noexcept {
        const double scaled = value / unit;
        return static_cast<std::int64_t>(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
    }
    static Stretch stretch(const Axis& axis, std::int64_t from, std::int64_t to) noexcept;
    std::size_t index(std::int64_t i, std::int64_t j) const noexcept {
        return static_cast<std::size_t>(j * (x_.count + 1) + i);
    }

    Axis x_, y_;
    std::vector<std::array<std::int64_t, 4>> sums_;
};

}  // namespace tessera
