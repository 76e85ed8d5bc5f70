#include "server/pattern/corner_patches.h"

#include <algorithm>
#include <cmath>

#include "server/pattern/look_mixture.h"

namespace tessera {
namespace {

std::uint64_t key_of(const std::array<std::uint16_t, 4>& states) noexcept {
    return std::uint64_t{states[0]} | std::uint64_t{states[1]} << 16 | std::uint64_t{states[2]} << 32 |
           std::uint64_t{states[3]} << 48;
}

}  // namespace

CornerPatches::CornerPatches(const CellProgram& program, const VaryingMap& map, const LookMeans& means,
                             std::int32_t slice, std::span<const std::int32_t> states, const Colour& base)
    : program_{program},
      means_{means},
      slice_{slice},
      states_{states},
      base_{base},
      columns_{basis_of(map.sampling, true, false)},
      rows_{basis_of(map.sampling, true, true)},
      cells_{std::int64_t{1} << map.map->cells_log2},
      column_probes_{probes_of(columns_, cells_)},
      row_probes_{probes_of(rows_, cells_)} {}

const CornerPatches::Combination& CornerPatches::combination(const std::array<std::uint16_t, 4>& corners) {
    const auto [at, is_new] = combinations_.try_emplace(key_of(corners));
    if (is_new) {
        const std::array<std::int32_t, 4> values{states_[corners[0]], states_[corners[1]],
                                                 states_[corners[2]], states_[corners[3]]};
        const LookMixture mixture = mixture_of(program_.shares(values), means_, slice_, base_);
        at->second = {mixture.mean, mixture.variance, mixture.range};
    }
    return at->second;
}

std::uint32_t CornerPatches::number(const std::array<std::uint16_t, 4>& entries) {
    const auto [at, is_new] =
        numbers_.try_emplace(key_of(entries), static_cast<std::uint32_t>(entries_.size()));
    if (is_new) entries_.push_back(entries);
    return at->second;
}

void CornerPatches::make() {
    for (const auto& entries : entries_) patches_.push_back(made(entries));
    numbers_ = {};
    combinations_ = {};
}

/// A corner's draw moves the mean of a cell by the largest difference that it can make there.
CornerSpread CornerPatches::spread_of(const std::vector<const Combination*>& shown, std::size_t kinds,
                                      bool drawn) {
    CornerSpread spread;
    for (const Combination* combination : shown)
        for (std::size_t c = 0; c < 4; ++c) {
            const double least = combination->range.least[c], most = combination->range.most[c];
            spread.width[c] = std::max(spread.width[c], most - least);
            spread.variance[c] = std::max(spread.variance[c], combination->variance[c]);
            spread.farthest[c] =
                std::max({spread.farthest[c], most - combination->mean[c], combination->mean[c] - least});
        }
    std::size_t stride = 1;
    for (std::size_t corner = 0; drawn && corner < 4; ++corner, stride *= kinds)
        for (std::size_t i = 0; i < shown.size(); ++i)
            for (std::size_t kind = i / stride % kinds + 1; kind < kinds; ++kind) {
                const Combination& other = *shown[i + (kind - i / stride % kinds) * stride];
                for (std::size_t c = 0; c < 4; ++c)
                    spread.corners[corner][c] =
                        std::max(spread.corners[corner][c], std::abs(shown[i]->mean[c] - other.mean[c]));
            }
    return spread;
}

/// The variance of what the corners leave as a cell's mean, from the expectations of the mean and its square.
void CornerPatches::measure_means(const PatchCoefficients& means, const PatchCoefficients& squares,
                                  const std::vector<const Combination*>& shown, CornerSpread& spread) const {
    ColourRange range;
    for (const Combination* combination : shown) range.add(combination->mean);
    for (std::size_t c = 0; c < 4; ++c) spread.means_width[c] = range.most[c] - range.least[c];
    const std::size_t functions = functions_of(columns_);
    Colour sum{};
    for (const auto& down : row_probes_.values) {
        std::array<Colour, most_functions> mean_of{}, square_of{};
        for (std::size_t row = 0; row < functions_of(rows_); ++row)
            for (std::size_t column = 0; column < functions; ++column)
                for (std::size_t c = 0; c < 4; ++c) {
                    mean_of[column][c] += down[row] * means[row * functions + column][c];
                    square_of[column][c] += down[row] * squares[row * functions + column][c];
                }
        for (const auto& across : column_probes_.values)
            for (std::size_t c = 0; c < 4; ++c) {
                double mean = 0, square = 0;
                for (std::size_t column = 0; column < functions; ++column) {
                    mean += across[column] * mean_of[column][c];
                    square += across[column] * square_of[column][c];
                }
                const double variance = std::max(square - mean * mean, 0.0);
                spread.means_variance[c] = std::max(spread.means_variance[c], variance);
                sum[c] += variance;
            }
    }
    const bool complete = column_probes_.complete && row_probes_.complete;
    const auto places =
        static_cast<double>(column_probes_.values.size()) * static_cast<double>(row_probes_.values.size());
    for (std::size_t c = 0; c < 4; ++c) {
        const double rounding = 1e-12 * spread.means_width[c] * spread.means_width[c];
        spread.means_variance[c] *= column_probes_.missed * row_probes_.missed;
        spread.means_variance[c] += rounding;
        spread.average_variance[c] = complete ? sum[c] / places + rounding : spread.means_variance[c];
    }
}

CornerPatches::Patch CornerPatches::made(const std::array<std::uint16_t, 4>& entries) {
    Patch patch;
    // The distinct states among the four entries
    std::vector<std::uint16_t> states{entries.begin(), entries.end()};
    std::sort(states.begin(), states.end());
    states.erase(std::unique(states.begin(), states.end()), states.end());
    const std::size_t kinds = states.size();

    const auto kinds_of = [&](std::size_t i) {
        return std::array<std::size_t, 4>{i % kinds, i / kinds % kinds, i / kinds / kinds % kinds,
                                          i / kinds / kinds / kinds};
    };
    std::vector<const Combination*> shown;
    for (std::size_t i = 0; i < kinds * kinds * kinds * kinds; ++i) {
        const auto kind = kinds_of(i);
        shown.push_back(&combination({states[kind[0]], states[kind[1]], states[kind[2]], states[kind[3]]}));
    }

    // Where corners are not drawn, they are what the map says
    const bool drawn = columns_ == PatchBasis::quartic || rows_ == PatchBasis::quartic;
    const std::size_t functions = functions_of(columns_);
    PatchCoefficients squares{};
    for (std::size_t row = 0; row < functions_of(rows_); ++row)
        for (std::size_t column = 0; column < functions; ++column) {
            // How often each corner of the cell at this sample is of which state
            std::array<std::array<double, 4>, 4> share{};
            for (std::size_t corner = 0; corner < 4; ++corner) {
                const double right =
                    right_weight(columns_, column, static_cast<int>(corner % 2), static_cast<double>(cells_));
                const double down =
                    right_weight(rows_, row, static_cast<int>(corner / 2), static_cast<double>(cells_));
                const std::array<double, 4> weights{(1 - right) * (1 - down), right * (1 - down),
                                                    (1 - right) * down, right * down};
                for (std::size_t entry = 0; entry < 4; ++entry) {
                    const auto kind = std::lower_bound(states.begin(), states.end(), entries[entry]);
                    share[corner][static_cast<std::size_t>(kind - states.begin())] += weights[entry];
                }
            }
            // The product over the combinations: corners are drawn independently
            Colour sum{}, &square = squares[row * functions + column];
            for (std::size_t i = 0; i < shown.size(); ++i) {
                const auto kind = kinds_of(i);
                const double weight =
                    share[0][kind[0]] * share[1][kind[1]] * share[2][kind[2]] * share[3][kind[3]];
                if (weight == 0) continue;
                for (std::size_t c = 0; c < 4; ++c) {
                    sum[c] += weight * shown[i]->mean[c];
                    square[c] += weight * shown[i]->mean[c] * shown[i]->mean[c];
                }
                patch.range.add(shown[i]->range);
            }
            patch.coefficients[row * functions + column] = sum;
        }
    patch.spread = spread_of(shown, kinds, drawn);
    if (drawn) measure_means(patch.coefficients, squares, shown, patch.spread);

    const auto over_columns = means_over(columns_, 0, cells_, cells_);
    const auto over_rows = means_over(rows_, 0, cells_, cells_);
    for (std::size_t row = 0; row < functions_of(rows_); ++row)
        for (std::size_t column = 0; column < functions; ++column)
            for (std::size_t c = 0; c < 4; ++c)
                patch.mean[c] +=
                    over_rows[row] * over_columns[column] * patch.coefficients[row * functions + column][c];
    return patch;
}

}  // namespace tessera
