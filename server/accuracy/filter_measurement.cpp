#include "server/accuracy/filter_measurement.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <ctime>
#include <limits>
#include <mutex>
#include <optional>

#include "server/prepare/parallel.h"

namespace tessera {
namespace {

/// Of this thread on a processor: what else the machine does counts for little.
double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

constexpr std::array<std::size_t, 3> probed_pixels{6, 6, 48};
constexpr std::size_t least_pixels = 16, least_timed = 8, most_timed = 2048;

/// `count` indices of [0, size), evenly spread and in order.
std::vector<std::size_t> evenly(std::size_t size, std::size_t count) {
    std::vector<std::size_t> chosen(std::min(size, count));
    for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = (2 * i + 1) * size / (2 * chosen.size());
    return chosen;
}

std::vector<Footprint> chosen_of(const View& view, const std::vector<std::size_t>& chosen) {
    std::vector<Footprint> footprints;
    footprints.reserve(chosen.size());
    for (const std::size_t i : chosen) footprints.push_back(view.footprints[i]);
    return footprints;
}

/// One filter while it is measured.
struct Candidate {
    const MeasuredFilter* filter = nullptr;
    std::unique_ptr<FootprintSampler> sampler;
    double seconds_per_sample = 0;  ///< A first guess.
    std::vector<Footprint> timed;
    std::vector<FilteredSample> samples;
    std::vector<double> nanoseconds;  ///< Of each round.
};

/// Adds up what a sample is off.
class Judge {
  public:
    Judge(const GroundTruth& truth, FilterMeasurement& out) : truth_{truth}, out_{out} {}

    void add(std::size_t index, std::size_t pixel, const FilteredSample& sample) {
        double worst = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double found = double(sample.color[c]);
            const double linear = (found - truth_.linear[index][c]) * 255;
            const double codes = fractional_srgb_code(found) - double(truth_.codes.codes[3 * pixel + c]);
            squares_ += codes * codes;
            linear_squares_ += linear * linear;
            out_.error.max_error = std::max(out_.error.max_error, std::fabs(codes));
            worst = std::max(worst, std::fabs(linear));
        }
        out_.worst_linear = std::max(out_.worst_linear, worst);
        out_.bound_codes = std::max(out_.bound_codes, sample.bound_codes);
        if (sample.confidence >= 1 && truth_.samples == 0)
            out_.beyond_bound = std::max(out_.beyond_bound, worst - sample.bound_codes);
        texels_ += static_cast<double>(sample.texels);
        ++count_;
    }
    void finish() {
        out_.pixels = count_;
        if (count_ == 0) return;
        const auto numbers = static_cast<double>(3 * count_);
        out_.error.mse = squares_ / numbers;
        out_.mse_linear = linear_squares_ / numbers;
        out_.error.psnr = out_.error.mse > 0
                              ? std::min(most_psnr, 10 * std::log10(255.0 * 255.0 / out_.error.mse))
                              : most_psnr;
        out_.texels_per_sample = texels_ / static_cast<double>(count_);
    }

  private:
    const GroundTruth& truth_;
    FilterMeasurement& out_;
    double squares_ = 0, linear_squares_ = 0, texels_ = 0;
    std::size_t count_ = 0;
};

struct SampledPixels {
    std::vector<FilteredSample> samples;
    double seconds = 0;  ///< Of all threads' processors.
};

/// All footprints on several threads, each with a sampler of its own.
Result<SampledPixels> sample_all(const std::vector<Footprint>& footprints, const MeasuredFilter& filter,
                                 const MeasureOptions& options) {
    const std::size_t run = std::clamp<std::size_t>(footprints.size() / 64, 1, 256);
    SampledPixels all;
    std::vector<FilteredSample>& samples = all.samples;
    samples.resize(footprints.size());
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::optional<Error> failure;
    for_each_index(options.threads, options.threads, [&](std::size_t) {
        const auto sampler = filter.make();
        const double started = processor_seconds();
        for (std::size_t begin = next.fetch_add(run); begin < footprints.size();
             begin = next.fetch_add(run)) {
            const std::size_t count = std::min(run, footprints.size() - begin);
            const auto done = sampler->sample(std::span{footprints}.subspan(begin, count), options.budget,
                                              std::span{samples}.subspan(begin, count));
            if (done) continue;
            const std::scoped_lock lock{mutex};
            if (!failure) failure = done.error();
            next = footprints.size();
        }
        const std::scoped_lock lock{mutex};
        all.seconds += processor_seconds() - started;
    });
    if (failure) return *failure;
    return all;
}

Result<FilterMeasurement> judge(const View& view, const GroundTruth& truth, const Candidate& candidate,
                                const MeasureOptions& options) {
    FilterMeasurement out;
    out.name = candidate.filter->name;
    const double expected = candidate.seconds_per_sample * static_cast<double>(view.footprints.size()) /
                            static_cast<double>(options.threads);
    const bool whole = expected <= options.picture_seconds;
    const auto affordable = static_cast<std::size_t>(static_cast<double>(view.footprints.size()) *
                                                     options.picture_seconds / expected);
    const std::vector<std::size_t> chosen =
        evenly(view.footprints.size(), whole ? view.footprints.size() : std::max(affordable, least_pixels));
    const auto sampled =
        sample_all(whole ? view.footprints : chosen_of(view, chosen), *candidate.filter, options);
    if (!sampled) return sampled.error();
    const std::vector<FilteredSample>& samples = sampled->samples;
    out.nanoseconds_per_sample =
        1e9 * sampled->seconds / static_cast<double>(std::max<std::size_t>(samples.size(), 1));

    Judge judged{truth, out};
    for (std::size_t i = 0; i < chosen.size(); ++i) judged.add(chosen[i], view.pixels[chosen[i]], samples[i]);
    judged.finish();
    out.error.ms_ssim = 0;
    if (!whole) return out;

    out.picture = truth.codes;
    out.texels.reserve(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            out.picture.codes[3 * view.pixels[i] + c] =
                static_cast<float>(fractional_srgb_code(double(samples[i].color[c])));
        out.texels.push_back(static_cast<std::uint32_t>(
            std::min<std::uint64_t>(samples[i].texels, std::numeric_limits<std::uint32_t>::max())));
    }
    out.error.ms_ssim = ms_ssim(truth.codes, out.picture, view.measured);
    return out;
}

}  // namespace

std::vector<bool> pareto_front(const std::vector<double>& costs, const std::vector<double>& errors) {
    std::vector<bool> front(costs.size(), true);
    for (std::size_t i = 0; i < costs.size(); ++i)
        for (std::size_t j = 0; j < costs.size(); ++j)
            if (costs[j] <= costs[i] && errors[j] <= errors[i] &&
                (costs[j] < costs[i] || errors[j] < errors[i]))
                front[i] = false;
    return front;
}

Result<std::vector<FilterMeasurement>> measure_filters(const View& view, const GroundTruth& truth,
                                                       const std::vector<MeasuredFilter>& filters,
                                                       const MeasureOptions& options,
                                                       const std::function<void(double)>& advance) {
    std::vector<Candidate> candidates;
    for (const MeasuredFilter& filter : filters) {
        Candidate candidate;
        candidate.filter = &filter;
        candidate.sampler = filter.make();
        // The first pass pays for tables and pages, the others tell what the rest will take
        bool cold = true;
        for (const std::size_t count : probed_pixels) {
            const std::vector<Footprint> probed = chosen_of(view, evenly(view.footprints.size(), count));
            std::vector<FilteredSample> samples(probed.size());
            const double begin = processor_seconds();
            if (const auto done = candidate.sampler->sample(probed, options.budget, samples); !done)
                return Error{done.error().code, filter.name + ": " + done.error().detail};
            const double seconds = processor_seconds() - begin;
            candidate.seconds_per_sample =
                seconds / static_cast<double>(std::max<std::size_t>(probed.size(), 1));
            if (seconds > options.picture_seconds / (cold ? 2 : 20)) break;
            cold = false;
        }
        candidates.push_back(std::move(candidate));
    }

    std::vector<FilterMeasurement> measured;
    for (const Candidate& candidate : candidates) {
        advance(0.6 * static_cast<double>(measured.size()) / static_cast<double>(candidates.size()));
        auto one = judge(view, truth, candidate, options);
        if (!one) return Error{one.error().code, candidate.filter->name + ": " + one.error().detail};
        measured.push_back(std::move(*one));
    }

    for (Candidate& candidate : candidates) {
        const double affordable = options.round_seconds / std::max(candidate.seconds_per_sample, 1e-9);
        // What takes long enough was timed as it was drawn
        if (affordable < least_timed) continue;
        const auto count = static_cast<std::size_t>(std::min(affordable, double(most_timed)));
        candidate.timed = chosen_of(view, evenly(view.footprints.size(), count));
        candidate.samples.resize(candidate.timed.size());
    }
    // Round −1 warms tables and caches
    for (int round = -1; round < options.rounds; ++round) {
        advance(0.6 + 0.4 * (round + 1) / (options.rounds + 1));
        for (Candidate& candidate : candidates) {
            if (candidate.timed.empty()) continue;
            const double begin = processor_seconds();
            const auto done = candidate.sampler->sample(candidate.timed, options.budget, candidate.samples);
            const double seconds = processor_seconds() - begin;
            if (!done) return Error{done.error().code, candidate.filter->name + ": " + done.error().detail};
            if (round >= 0)
                candidate.nanoseconds.push_back(1e9 * seconds / static_cast<double>(candidate.timed.size()));
        }
    }
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        std::vector<double>& times = candidates[i].nanoseconds;
        if (times.empty()) continue;
        const auto middle = times.begin() + std::ssize(times) / 2;
        std::nth_element(times.begin(), middle, times.end());
        measured[i].nanoseconds_per_sample = *middle;
    }
    return measured;
}

}  // namespace tessera
