#include "server/sampling/sample_plan.h"

#include <numeric>

namespace tessera {
namespace {

/// Only filters whose bounds say something about the footprint; see README.md for what each step costs.
std::vector<SampleStep> ladder() {
    const FootprintFilter line{.kind = FilterKind::line_integral, .direction = LineDirection::best};
    const FootprintFilter exact{.kind = FilterKind::exact};
    return {
        {line, Accuracy::fast}, {exact, Accuracy::fast}, {exact, Accuracy::high}, {exact, Accuracy::exact}};
}

}  // namespace

SamplePlan choose_filter(const std::optional<FootprintFilter>& filter, Accuracy accuracy,
                         std::optional<double> max_error) {
    if (filter) return {{{*filter, accuracy}}, 0};
    if (max_error) return {ladder(), *max_error};
    switch (accuracy) {
        case Accuracy::fast:
            return {ladder(), fast_enough_codes};
        case Accuracy::high:
            return {ladder(), high_enough_codes};
        case Accuracy::exact:
            break;
    }
    return {{{{.kind = FilterKind::exact}, Accuracy::exact}}, 0};
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
