#pragma once

#include <span>

#include "server/blocks/cell_program.h"
#include "server/pattern/chance_bounds.h"
#include "server/pattern/look_means.h"

namespace tessera {

/// What a cell shows on average where the map's states are given. Colours are told from a base colour, so
/// that where all are equal nothing is left to round.
struct LookMixture {
    Colour mean{};
    Colour variance{};
    ColourRange range;
};

inline LookMixture mixture_of(std::span<const LookShare> shares, const LookMeans& means, std::int32_t slice,
                              const Colour& base) {
    LookMixture mixture;
    Colour squares{};
    for (const LookShare& share : shares) {
        if (share.share <= 0) continue;
        const Colour colour = means.of(share, slice);
        Colour difference;
        for (std::size_t c = 0; c < 4; ++c) {
            difference[c] = colour[c] - base[c];
            mixture.mean[c] += share.share * difference[c];
            squares[c] += share.share * difference[c] * difference[c];
        }
        mixture.range.add(difference);
    }
    for (std::size_t c = 0; c < 4; ++c)
        mixture.variance[c] = std::max(0.0, squares[c] - mixture.mean[c] * mixture.mean[c]);
    return mixture;
}

/// The colour of the first look, to tell the others from.
inline Colour base_of(std::span<const LookShare> shares, const LookMeans& means, std::int32_t slice) {
    for (const LookShare& share : shares)
        if (share.share > 0) return means.of(share, slice);
    return {};
}

}  // namespace tessera
