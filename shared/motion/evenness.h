#pragma once

#include <cstdint>
#include <span>

#include "shared/motion/cycle.h"

namespace tessera {

struct WeightedPhase {
    std::int64_t phase = 0;
    double weight = 0;  ///< All sum to 1.
};

/// Cells with random phases show each frame about as often as it is shown in time. This is how far, at any
/// step, at most: half the sum over the frames of |share of cells − share of steps|. 0 where the phases are
/// as many whole cycles; up to 1 where they all are the same. `phases` is not empty.
double uneven_frames(const TimeLine& line, std::int64_t rest, std::span<const WeightedPhase> phases);

}  // namespace tessera
