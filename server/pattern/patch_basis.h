#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/blocks/cell_program.h"

namespace tessera {

/// How an expectation runs along one axis of a map's *patch*: the 2^cells_log2 cells between one entry and
/// the next. It is a sum of these functions, each 1 at its own sample and 0 at the others.
enum class PatchBasis : std::uint8_t {
    whole,    ///< One value for all cells: nearest.
    linear,   ///< From this entry to the next: dithered.
    pieces,   ///< One for all cells but the last, whose corners reach into the next patch: corners, nearest.
    quartic,  ///< Each of the four corners is linear: corners, dithered.
};

inline constexpr std::size_t most_functions = 5;

constexpr std::size_t functions_of(PatchBasis basis) noexcept {
    constexpr std::array<std::size_t, 4> count{1, 2, 2, most_functions};
    return count[static_cast<std::size_t>(basis)];
}

/// Along x (or, `vertical`, along y).
constexpr PatchBasis basis_of(VaryingMap::Sampling sampling, bool corners, bool vertical) noexcept {
    const bool dithered =
        sampling == VaryingMap::Sampling::dithered ||
        sampling == (vertical ? VaryingMap::Sampling::dithered_y : VaryingMap::Sampling::dithered_x);
    if (corners) return dithered ? PatchBasis::quartic : PatchBasis::pieces;
    return dithered ? PatchBasis::linear : PatchBasis::whole;
}

/// How much of the entry to the right a corner of a cell takes at a sample: `corner` 0 or 1 cells on.
double right_weight(PatchBasis basis, std::size_t sample, int corner, double cells) noexcept;

/// The mean of each function over `count` cells from `first` on, of the patch's `cells` (powers of two).
std::array<double, most_functions> means_over(PatchBasis basis, std::int64_t first, std::int64_t count,
                                              std::int64_t cells) noexcept;

/// Where the largest value of something quadratic in such sums is looked for: pieces and quartic.
struct PatchProbes {
    std::vector<std::array<double, most_functions>> values;  ///< Of the functions, at each place.
    bool complete = false;  ///< These are all places, each as often as it occurs.
    double missed = 1;      ///< Between places it is at most so many times as large.
};
PatchProbes probes_of(PatchBasis basis, std::int64_t cells);

}  // namespace tessera
