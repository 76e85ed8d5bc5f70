#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "server/filter/footprint_filter.h"
#include "server/sampling/sample_plan.h"
#include "server/sampling/sample_request.h"

namespace tessera {

/// proto::SampleAnswer, as protobuf or as JSON: the same message, laid out for people with a footprint's
/// colour a line. Bounds are rounded up to floats, and confidences down, so that what is said of a colour
/// stays true. `steps_taken` are indices into the plan's steps, one a sample.
std::string write_sample_answer(const SamplePlan& plan, std::span<const FilteredSample> samples,
                                std::span<const std::uint8_t> steps_taken, std::uint64_t revision,
                                std::chrono::nanoseconds time, WireCoding coding);

}  // namespace tessera
