#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "server/pattern/area_sums.h"

namespace tessera {

/// How far a mean of many draws may be from its expectation.
struct ChanceBound {
    double codes = 0;
    double confidence = 1;  ///< 1: certain.
};

/// Bounds that are not certain hold with this probability for all four channels of a texel.
inline constexpr double stated_confidence = 1 - 1e-9;
/// ln(2 · 4 channels / 1e-9): what is left of it after the exponential's inverse.
inline constexpr double log_of_odds = 22.80270737862625;

/// The least and the largest of each channel of the colours that a cell may show.
struct ColourRange {
    Colour least{1e9, 1e9, 1e9, 1e9};
    Colour most{-1e9, -1e9, -1e9, -1e9};

    void add(const Colour& colour) noexcept {
        for (std::size_t c = 0; c < 4; ++c) {
            least[c] = std::min(least[c], colour[c]);
            most[c] = std::max(most[c], colour[c]);
        }
    }
    void add(const ColourRange& range) noexcept {
        for (std::size_t c = 0; c < 4; ++c) {
            least[c] = std::min(least[c], range.least[c]);
            most[c] = std::max(most[c], range.most[c]);
        }
    }
    /// Of the channel where it is largest; 0 if nothing was added.
    double width() const noexcept {
        double width = 0;
        for (std::size_t c = 0; c < 4; ++c) width = std::max(width, most[c] - least[c]);
        return width;
    }
};

/// Hoeffding's inequality for the mean of `cells` draws that each span at most `width` (linear).
inline double chance_codes(double width, double cells) noexcept {
    return 255 * width * std::sqrt(log_of_odds / (2 * cells));
}

/// What draws may do to one cell's share of a mean, one after the other: the variance that they add, and how
/// far any one of them may move it (linear; Σ over the draws of a cell, but for `farthest`).
struct DrawSpread {
    double variance = 0;
    double squares = 0;   ///< Of what each draw spans.
    double farthest = 0;  ///< From what was expected before the draw.

    void add_largest(const DrawSpread& other) noexcept {
        variance = std::max(variance, other.variance);
        squares = std::max(squares, other.squares);
        farthest = std::max(farthest, other.farthest);
    }
};

/// What is drawn for cells that look at draws of their four corners, too.
struct CornerSpread {
    Colour variance{}, width{}, farthest{};  ///< Of a cell's own draws, where its corners are given.
    std::array<Colour, 4> corners{};  ///< What a corner's draw makes of the mean of each cell that has it.
    /// Of the mean that a cell's corners leave it, over all that may be drawn for them: its variance, where
    /// that is largest and on the average of the cells, and what it spans.
    Colour means_variance{}, average_variance{}, means_width{};

    void add_largest(const CornerSpread& other) noexcept {
        const auto add = [](Colour& to, const Colour& from) {
            for (std::size_t c = 0; c < 4; ++c) to[c] = std::max(to[c], from[c]);
        };
        add(variance, other.variance);
        add(width, other.width);
        add(farthest, other.farthest);
        for (std::size_t k = 0; k < 4; ++k) add(corners[k], other.corners[k]);
        add(means_variance, other.means_variance);
        add(average_variance, other.average_variance);
        add(means_width, other.means_width);
    }
    /// As many corners as cells are drawn, and each moves the four cells around it: what lies within a span
    /// has a variance of at most a quarter of its square (Popoviciu). At the edge of n × n cells corners move
    /// fewer: those of two opposite edges together, with (a + b)² ≥ a² + b², no more than one row inside, so
    /// that n² is right.
    ///
    /// `classes`: cells may share their own draws with neighbours, too, but not inside one of so many
    /// classes. Given the corners, the mean of a class is one of independent cells, and the mean of all that
    /// of the classes' means: as if there were so many times fewer cells (Hoeffding, "Probability
    /// inequalities for sums of bounded random variables", 1963, 5d).
    DrawSpread of_cell(double classes) const noexcept {
        DrawSpread spread;
        for (std::size_t c = 0; c < 4; ++c) {
            const double corner = corners[0][c] + corners[1][c] + corners[2][c] + corners[3][c];
            spread.add_largest({classes * variance[c] + corner * corner / 4,
                                classes * width[c] * width[c] + corner * corner,
                                std::max(classes * farthest[c], corner)});
        }
        return spread;
    }
    /// The same by classes for the corners, too: cells whose columns and rows are even or odd alike share no
    /// corner. By Hölder's inequality the sum of four classes' sums is one of independent cells, of four
    /// times the variance each (and a fourth of what Popoviciu allows, where a corner counts for a quarter of
    /// each of its cells). `average`: of all of a patch's cells, instead of the worst.
    DrawSpread of_classes(double classes, bool average) const noexcept {
        DrawSpread spread;
        for (std::size_t c = 0; c < 4; ++c) {
            const double means = 4 * (average ? average_variance : means_variance)[c];
            spread.add_largest({classes * variance[c] + means,
                                classes * width[c] * width[c] + 4 * means_width[c] * means_width[c],
                                std::max(classes * farthest[c], 4 * means_width[c])});
        }
        return spread;
    }
};

/// A mean over `cells` of them whose draws are independent of each other, each perhaps seen by several cells.
/// Drawn one after the other they make a martingale, whose end is this far from its start at most: by
/// McDiarmid's inequality, or by Freedman's ("On tail probabilities for martingales", Annals of Probability
/// 3, 1975), which is Bernstein's where draws do not share cells.
inline double spread_codes(const DrawSpread& spread, double cells) noexcept {
    const double linear = spread.farthest * log_of_odds / 3;
    const double freedman =
        (linear + std::sqrt(linear * linear + 2 * cells * log_of_odds * spread.variance)) / cells;
    return 255 * std::min(freedman, std::sqrt(log_of_odds * spread.squares / (2 * cells)));
}

}  // namespace tessera
