#pragma once

#include <algorithm>
#include <cmath>

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

/// Hoeffding's inequality for the mean of `cells` draws that each span at most `width` (linear); where cells
/// share draws with neighbours, Janson's ("Large deviations for sums of partly dependent random variables",
/// Random Structures & Algorithms 24, 2004): they fall into `classes` sets inside of which none do.
inline double chance_codes(double width, double cells, int classes = 1) noexcept {
    return 255 * width * std::sqrt(classes * log_of_odds / (2 * cells));
}

}  // namespace tessera
