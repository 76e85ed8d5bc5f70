#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace tessera::tests {

/// How a generator draws: one of `draw_kinds` for the cell (x, y).
using CellGenerator = std::function<std::int32_t(std::int64_t x, std::int64_t y)>;

inline constexpr std::int32_t draw_kinds = 16;

/// What 256 × 256 draws from the cell (at, at) on look like, and those at the origin beside them.
struct GeneratorMeasure {
    /// χ² of how often each kind is drawn, in standard deviations from its mean: chance is within 5; less is
    /// too even.
    double evenness = 0;
    /// The same of pairs of neighbours, along x and y whichever is further off, against independence.
    double dependence = 0;
    double alike_neighbours = 0;  ///< Share of cells that draw what the next along x draws; chance: 1/16.
    double alike_far = 0;         ///< Share of cells that draw what the cell as far from the origin draws.
};
GeneratorMeasure measure(const CellGenerator& draw, std::int64_t at);

/// Whether chance would give these.
bool looks_random(const GeneratorMeasure& measure, bool at_origin);

/// The least k for which the draws from 2^k on are not `passes`; −1 if there is none up to 2^max_log2.
int breaks_at(const CellGenerator& draw, int max_log2,
              const std::function<bool(const GeneratorMeasure&)>& passes);

/// The paper's permutation series (Lefebvre & Neyret 3.2; server/blocks/sigma_series.h) as a shader computes
/// it: coordinates, quotients and remainders in Real. `table`: σ.
template <class Real>
CellGenerator sigma_in(std::vector<std::int32_t> table);

/// Kolář's formula (equation 1; server/texture/kolar_choice.h) in Real, with the C library's sine and cosine.
template <class Real>
CellGenerator kolar_in(double alpha, double beta);

}  // namespace tessera::tests
