#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "server/filter/footprint_filter.h"
#include "server/filter/footprint_sampler.h"
#include "server/texture/texture.h"

namespace tessera {

/// One way to answer: a filter, and how accurate the texels are that it reads.
struct SampleStep {
    FootprintFilter filter;
    Accuracy texels = Accuracy::high;
    bool operator==(const SampleStep&) const = default;
};

/// The ways that a request allows, the cheapest first. A footprint is answered by the first one whose bound
/// is at most `enough_codes`; by the one with the least bound where none is.
struct SamplePlan {
    std::vector<SampleStep> steps;  ///< At least one.
    double enough_codes = 0;
};

/// A filter that is asked for by name is the only step, on texels of this accuracy. An error limit is worth
/// any filter, up to exact ones on exact texels, which may take milliseconds for a footprint of millions of
/// texels. Without one, what a footprint may cost has an end:
///  - exact: the exact filter on exact texels, at once.
///  - high: a line integral on `high` texels. Within 0.002 codes of the texels' own bound for footprints of
///  up to
///    1,024 lines; beyond that of a coarser level, within a few codes.
///  - fast: a line integral of at most 128 lines on `fast` texels, and of 1,024 where that is off by more
///  than
///    `fast_enough_codes`.
SamplePlan choose_filter(const std::optional<FootprintFilter>& filter, Accuracy accuracy,
                         std::optional<double> max_error);
inline constexpr double fast_enough_codes = 4;

/// Samples `footprints` as the plan says: each starts at the first step and goes on to the next only where
/// its bound is too large. `samples[i].texels` counts every try; `steps_taken[i]` is the index of the step
/// that answered. Where a bound at a confidence was chosen after others, its confidence is what is left of it
/// when all of them may fail. What one footprint gets does not depend on the others.
using RunStep =
    std::function<Result<void>(const SampleStep&, std::span<const Footprint>, std::span<FilteredSample>)>;
Result<void> sample_by(const SamplePlan& plan, std::span<const Footprint> footprints, const RunStep& run,
                       std::span<FilteredSample> samples, std::span<std::uint8_t> steps_taken);

}  // namespace tessera
