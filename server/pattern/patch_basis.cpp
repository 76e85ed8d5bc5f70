#include "server/pattern/patch_basis.h"

#include <cmath>
#include <numbers>

namespace tessera {
namespace {

/// Lagrange's polynomials of the samples 0, 1/4, 1/2, 3/4 and 1.
std::array<double, most_functions> lagrange(double t) noexcept {
    std::array<double, most_functions> values;
    for (std::size_t i = 0; i < most_functions; ++i) {
        double value = 1;
        for (std::size_t j = 0; j < most_functions; ++j)
            if (j != i)
                value *= (4 * t - static_cast<double>(j)) / (static_cast<double>(i) - static_cast<double>(j));
        values[i] = value;
    }
    return values;
}

}  // namespace

double right_weight(PatchBasis basis, std::size_t sample, int corner, double cells) noexcept {
    switch (basis) {
        case PatchBasis::whole:
            return 0;
        case PatchBasis::linear:
            return static_cast<double>(sample);
        case PatchBasis::pieces:
            return sample == 0 ? 0 : corner;
        case PatchBasis::quartic:
            break;
    }
    return static_cast<double>(sample) / 4 + corner / cells;
}

std::array<double, most_functions> means_over(PatchBasis basis, std::int64_t first, std::int64_t count,
                                              std::int64_t cells) noexcept {
    const auto n = static_cast<double>(count), side = static_cast<double>(cells);
    const double centre = (static_cast<double>(first) + (n - 1) / 2) / side;
    switch (basis) {
        case PatchBasis::whole:
            return {1};
        case PatchBasis::linear:
            return {1 - centre, centre};
        case PatchBasis::pieces: {
            const double last = first + count == cells ? 1 / n : 0;
            return {1 - last, last};
        }
        case PatchBasis::quartic:
            break;
    }
    // Three points give the exact mean of a polynomial of degree five over n equally spaced ones: the
    // discrete Gauss rule. From the second and fourth moments, (n² − 1)/12 and (n² − 1)(3n² − 7)/240.
    if (count == 1) return lagrange(centre);
    const double square = (3 * n * n - 7) / 20;
    const double outer = (n * n - 1) / 24 / square;
    const double aside = std::sqrt(square) / side;
    const auto middle = lagrange(centre), left = lagrange(centre - aside), right = lagrange(centre + aside);
    std::array<double, most_functions> means;
    for (std::size_t i = 0; i < most_functions; ++i)
        means[i] = (1 - 2 * outer) * middle[i] + outer * (left[i] + right[i]);
    return means;
}

PatchProbes probes_of(PatchBasis basis, std::int64_t cells) {
    constexpr std::int64_t most = 32;
    PatchProbes probes;
    if (cells <= most) {
        probes.complete = true;
        for (std::int64_t cell = 0; cell < cells; ++cell)
            probes.values.push_back(means_over(basis, cell, 1, cells));
        return probes;
    }
    if (basis != PatchBasis::quartic) {
        // One of two values
        probes.values = {means_over(basis, 0, 1, cells), means_over(basis, cells - 1, 1, cells)};
        return probes;
    }
    // A polynomial of degree eight is at most 1 / cos(8π / 2m) times as large as at m of Chebyshev's nodes
    // (Ehlich and Zeller, "Schwankung von Polynomen zwischen Gitterpunkten", 1964)
    for (int i = 0; i < most; ++i)
        probes.values.push_back(
            lagrange(0.5 + 0.5 * std::cos((i + 0.5) * std::numbers::pi / static_cast<double>(most))));
    probes.missed = 1 / std::cos(8 * std::numbers::pi / (2.0 * static_cast<double>(most)));
    return probes;
}

}  // namespace tessera
