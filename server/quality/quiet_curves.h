#pragma once

#include <cstdint>

#include "server/quality/histogram.h"
#include "server/quality/measures.h"
#include "server/quality/progress_part.h"

namespace tessera {

/// What borders could cost if nothing were exchanged: the exemplar's own steps along the quietest closed
/// curves around some of its places. Each curve is the one with the smallest sum of steps of all that go once
/// around a square of `side` texels, without what is nearer to its middle than 0.4 of the way to its sides.
/// Nine places, spread evenly; larger squares than 128 count as 128. Empty where the exemplar is smaller than
/// the square. An estimate, not a bound: curves of the smallest sum need not have the smallest mean. Errors:
/// cancelled.
Result<Histogram> steps_of_quiet_curves(const Rgb8Image& exemplar, std::int32_t side,
                                        const ProgressPart& progress);

}  // namespace tessera
