#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/accuracy/ground_truth.h"
#include "server/filter/footprint_sampler.h"

namespace tessera {

/// A filter that is measured: by name, and how to make one for a thread.
struct MeasuredFilter {
    std::string name;
    std::function<std::unique_ptr<FootprintSampler>()> make;
};

/// What one filter did on one view of one texture.
struct FilterMeasurement {
    std::string name;
    CodeImage picture;  ///< As GroundTruth::codes; empty where only some pixels were asked for.
    std::vector<std::uint32_t> texels;  ///< Fetched for each of View::pixels; empty likewise.
    std::size_t pixels = 0;             ///< Measured.
    ImageError error;                   ///< ms_ssim is 0 where there is no picture.
    double mse_linear = 0;              ///< In codes of linear light.
    double worst_linear = 0;            ///< Codes of linear light.
    double bound_codes = 0;             ///< The greatest that was stated.
    /// How far the worst sample lies beyond its own certain bound; 0 unless a bound is wrong. Only told where
    /// the truth is analytic.
    double beyond_bound = 0;
    double texels_per_sample = 0;
    double nanoseconds_per_sample = 0;  ///< Processor time of one thread, median of rounds.
};

struct MeasureOptions {
    std::size_t threads = 2;       ///< For pictures; times are taken on one.
    int rounds = 5;                ///< Every filter once in each, so that noise hits all alike.
    double round_seconds = 0.012;  ///< A filter's part of a round.
    double picture_seconds = 3;    ///< A filter that takes longer is asked for evenly spread pixels only.
    Budget budget;                 ///< Its cancellation is heeded.
};

/// Measures all filters. `advance` hears of fractions. Errors: cancelled; what a sampler says.
Result<std::vector<FilterMeasurement>> measure_filters(const View& view, const GroundTruth& truth,
                                                       const std::vector<MeasuredFilter>& filters,
                                                       const MeasureOptions& options,
                                                       const std::function<void(double)>& advance);

/// For each point whether no other is at most as costly and at most as wrong, and better in one of both.
std::vector<bool> pareto_front(const std::vector<double>& costs, const std::vector<double>& errors);

}  // namespace tessera
