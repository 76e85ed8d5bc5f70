#include "server/pattern/map_bounds.h"

#include <algorithm>
#include <cmath>

namespace tessera {

void MapSpread::add_entries(std::span<const LookMixture* const> entries) noexcept {
    ColourRange means, shown;
    double variance = 0;
    for (const LookMixture* entry : entries) {
        means.add(entry->mean);
        shown.add(entry->range);
        for (const double channel : entry->variance) variance = std::max(variance, channel);
    }
    const double of_means = means.width(), width = shown.width();
    cells.add_largest({variance + of_means * of_means / 4, width * width, width});
    range.add(shown);
}

MapBounds::CellDraws MapBounds::draws_of(const MapSpread& spread) const noexcept {
    if (!corners_) return {spread.cells, spread.cells};
    return {spread.corners.of_cell(sharing_), spread.corners.of_classes(sharing_, false)};
}

void MapBounds::add_patch(double share, const MapSpread& patch, CellDraws& all) const noexcept {
    const auto add = [](const DrawSpread& cell, double part, double reach, DrawSpread& to) {
        to.variance += part * cell.variance;
        to.squares += part * cell.squares;
        to.farthest = std::max(to.farthest, reach * cell.farthest);
    };
    // Corners at the border of patches lie in up to four of them, each of which moves some of their cells:
    // (a + b)² ≤ 2·(a² + b²)
    const double at_borders = 1 + 1 / static_cast<double>(std::int64_t{1} << cells_log2_);
    const CellDraws cell = draws_of(patch);
    add(cell.in_turn, share * at_borders * at_borders, 2, all.in_turn);
    add(corners_ ? patch.corners.of_classes(sharing_, true) : cell.in_classes, share, 1, all.in_classes);
}

ChanceBound MapBounds::of(int up, const CellDraws& cell, const ColourRange& shown) const noexcept {
    const double side = static_cast<double>(std::int64_t{1} << up), cells = side * side;
    if (cell.in_turn.squares <= 0) return {};
    const double range = shown.width();
    double codes = 255 * range;  // Both lie among the colours that cells may show
    if (independent_) {
        for (DrawSpread draws : {cell.in_turn, cell.in_classes}) {
            // Shares that lie elsewhere shift a mean by so much of the range, and what a corner makes of four
            // means by eight times that
            draws.farthest += 8 * uneven_ * range;
            draws.squares += 128 * uneven_ * range * range;
            draws.variance += (3 + 128.0 / 4) * uneven_ * range * range;
            codes = std::min(codes, spread_codes(draws, cells));
        }
    } else if (nested_) {
        const ChanceBound bound = nested_codes(up, range);
        if (bound.codes < codes) return bound;
    }
    return {codes, codes < 255 * range ? stated_confidence : 1};
}

/// Nested thresholds dither: of each aligned block of 4^j cells, the number below a threshold is right within
/// one; the bilinear weights that they are held against change inside a block by 2·(2^j − 1) cells' worth at
/// most. The three weights between four entries each shift the colour by the looks' range at most; one entry
/// shows one look.
ChanceBound MapBounds::nested_codes(int up, double range) const noexcept {
    const auto side = static_cast<double>(std::int64_t{1} << cells_log2_);
    double least = 1;
    for (int j = 0; j <= std::min(up, cells_log2_); ++j) {
        const auto block = static_cast<double>(std::int64_t{1} << j);
        least = std::min(least, 1 / (block * block) + 2 * (block - 1) / side);
    }
    const double cells =
        static_cast<double>(std::int64_t{1} << up) * static_cast<double>(std::int64_t{1} << up);
    const double certain = 255 * 3 * range * least, likely = nested_chance_codes(cells, range);
    if (certain <= likely) return {certain, 1};
    return {likely, stated_confidence};
}

/// Thresholds are revealed digit by digit. A digit is a permutation of four, drawn for each node and each
/// stratum (what the digits before it say), of the four cells of the node that lie in it. What four cells are
/// expected to show then changes by a variance of a third of the sum of squares (Hoeffding, "A combinatorial
/// central limit theorem", 1951), so by a third of range² a cell at most (Popoviciu), and not at all for
/// cells that no threshold of theirs divides any more. Of those, three at most a cell, each digit leaves a
/// quarter on the average: how many more is Bernstein's, again.
double nested_chance_codes(double cells, double range) noexcept {
    constexpr int digits = 16;
    // Half of what the confidence leaves is for the sum, and half for the numbers of cells
    constexpr double odds = log_of_odds + 0.6931471805599453, odds_each = odds + 2.772588722239781;
    double thresholds = 3 * cells, undecided = 0;
    for (int digit = 0; digit < digits; ++digit) {
        undecided += std::min(cells, thresholds);
        // A group of four cells divides twelve thresholds at most; its variance is as above, with 3² / 4
        const double variance = std::min(cells, thresholds) * 3, farthest = 12;
        const double more = (farthest * odds_each / 3 +
                             std::sqrt(std::pow(farthest * odds_each / 3, 2) + 2 * odds_each * variance));
        thresholds = std::min(thresholds, thresholds / 4 + more);
    }
    const double linear = 4 * range * odds / 3, variance = undecided / 3 * range * range;
    return 255 * (linear + std::sqrt(linear * linear + 2 * odds * variance)) / cells;
}

}  // namespace tessera
