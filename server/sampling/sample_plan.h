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

/// What `accuracy` is worth where no error limit is given, in codes: `fast` must look right, `high` must not
/// be told from exact in an 8-bit picture. `exact` is the exact filter on exact texels, at once.
inline constexpr double fast_enough_codes = 4, high_enough_codes = 0.5;

/// A filter that is asked for by name is the only step, on texels of this accuracy.
SamplePlan choose_filter(const std::optional<FootprintFilter>& filter, Accuracy accuracy,
                         std::optional<double> max_error);

/// Samples `footprints` as the plan says: each starts at the first step and goes on to the next only where
/// its bound is too large. `samples[i].texels` counts every try; `steps_taken[i]` is the index of the step
/// that answered. Where a bound at a confidence was chosen after others, its confidence is what is left of it
/// when all of them may fail. What one footprint gets does not depend on the others.
using RunStep =
    std::function<Result<void>(const SampleStep&, std::span<const Footprint>, std::span<FilteredSample>)>;
Result<void> sample_by(const SamplePlan& plan, std::span<const Footprint> footprints, const RunStep& run,
                       std::span<FilteredSample> samples, std::span<std::uint8_t> steps_taken);

}  // namespace tessera
