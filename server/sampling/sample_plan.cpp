#include "server/sampling/sample_plan.h"

#include <numeric>

namespace tessera {
namespace {

/// Only filters whose bounds say something of a footprint. Measured on footprints of 16 to 2,000 texels a
/// side (README.md): a line integral costs a third of the exact filter and less, one of few lines a tenth of
/// that.
constexpr FootprintFilter few_lines{.kind = FilterKind::line_integral, .lines = 128},
    all_lines{.kind = FilterKind::line_integral}, exact{.kind = FilterKind::exact};

/// A line integral of so few lines is within this of the truth only where footprints are compact.
constexpr double few_lines_codes = 2;

}  // namespace

SamplePlan choose_filter(const std::optional<FootprintFilter>& filter, Accuracy accuracy,
                         std::optional<double> max_error) {
    if (filter) return {{{*filter, accuracy}}, 0};
    if (max_error) {
        SamplePlan plan{{}, *max_error};
        if (*max_error >= few_lines_codes) plan.steps.push_back({few_lines, Accuracy::fast});
        plan.steps.insert(plan.steps.end(), {{all_lines, Accuracy::fast},
                                             {exact, Accuracy::fast},
                                             {exact, Accuracy::high},
                                             {exact, Accuracy::exact}});
        return plan;
    }
    switch (accuracy) {
        case Accuracy::fast:
            return {{{few_lines, Accuracy::fast}, {all_lines, Accuracy::fast}}, fast_enough_codes};
        case Accuracy::high:
            return {{{all_lines, Accuracy::high}}, 0};
        case Accuracy::exact:
            break;
    }
    return {{{exact, Accuracy::exact}}, 0};
}

Result<void> sample_by(const SamplePlan& plan, std::span<const Footprint> footprints, const RunStep& run,
                       std::span<FilteredSample> samples, std::span<std::uint8_t> steps_taken) {
    std::vector<std::size_t> open(footprints.size());  // not yet answered well enough
    std::iota(open.begin(), open.end(), std::size_t{0});
    std::vector<Footprint> asked;
    std::vector<FilteredSample> tried;
    std::vector<double> doubt(footprints.size(), 0.0);  // that some bound of this footprint is wrong
    for (std::size_t step = 0; step < plan.steps.size() && !open.empty(); ++step) {
        asked.clear();
        for (const std::size_t i : open) asked.push_back(footprints[i]);
        tried.assign(open.size(), {});
        if (const auto done = run(plan.steps[step], asked, tried); !done) return done;

        std::size_t still_open = 0;
        for (std::size_t n = 0; n < open.size(); ++n) {
            const std::size_t i = open[n];
            const std::uint64_t texels = samples[i].texels * (step > 0) + tried[n].texels;
            doubt[i] += 1 - tried[n].confidence;
            if (step == 0 || tried[n].bound_codes < samples[i].bound_codes) {
                samples[i] = tried[n];
                steps_taken[i] = static_cast<std::uint8_t>(step);
            }
            samples[i].texels = texels;
            if (samples[i].bound_codes > plan.enough_codes) open[still_open++] = i;
        }
        open.resize(still_open);
    }
    for (std::size_t i = 0; i < footprints.size(); ++i)
        if (samples[i].confidence < 1) samples[i].confidence = 1 - doubt[i];
    return {};
}

}  // namespace tessera
