// What a sample costs with every filter that the report compares, over the pixels of a situation.

#include <cmath>
#include <random>

#include <benchmark/benchmark.h>

#include "server/filter/footprint_sampler.h"
#include "shared/situations/situation.h"

namespace tessera {
namespace {

/// Smooth enough that neighbouring texels are alike, with details of all sizes.
LinearImage made_photograph(std::int32_t side) {
    LinearImage image{side, side};
    std::mt19937 random{1};
    for (float& v : image.values) v = static_cast<float>(random() % 256) / 1024;
    for (std::int32_t size = 4; size <= side / 2; size *= 4) {
        std::vector<float> coarse(static_cast<std::size_t>((side / size) * (side / size)));
        for (float& v : coarse) v = static_cast<float>(random() % 256) / 1024;
        for (std::int32_t y = 0; y < side; ++y)
            for (std::int32_t i = 0; i < 4 * side; ++i)
                image.row(y)[i] +=
                    coarse[static_cast<std::size_t>((y / size) * (side / size) + i / 4 / size)];
    }
    for (float& v : image.values) v = std::fmin(v, 1.0F);
    return image;
}

struct View {
    std::shared_ptr<const TexelPages> pages = pages_of_image(made_photograph(1024), Beyond::repeat);
    std::vector<Footprint> footprints;
    std::vector<FilteredSample> truth;

    explicit View(std::size_t situation) {
        const Situation view = situations(160, 140)[situation];
        for (std::int32_t y = 0; y < view.height; ++y)
            for (std::int32_t x = 0; x < view.width; ++x)
                if (const auto footprint = footprint_of(view, x, y)) footprints.push_back(*footprint);
        truth.resize(footprints.size());
        make_sampler({.kind = FilterKind::exact}, pages)->sample(footprints, {}, truth).value();
    }
};

void sample(benchmark::State& state, const FootprintFilter& filter, const View& view) {
    const auto sampler = make_sampler(filter, view.pages);
    std::vector<FilteredSample> samples(view.footprints.size());
    sampler->sample(view.footprints, {}, samples).value();
    double squares = 0;
    std::uint64_t texels = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        for (std::size_t c = 0; c < 4; ++c) {
            const double error = static_cast<double>(samples[i].color[c] - view.truth[i].color[c]) * 255;
            if (!(std::fabs(error) <= samples[i].bound_codes + view.truth[i].bound_codes))
                return state.SkipWithError("a sample is further from the truth than its bound");
            squares += error * error / 4;
        }
        texels += samples[i].texels;
    }
    for (auto _ : state) {
        sampler->sample(view.footprints, {}, samples).value();
        benchmark::DoNotOptimize(samples.data());
    }
    const auto count = static_cast<double>(samples.size());
    state.counters["ns/sample"] = benchmark::Counter(
        count * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    state.counters["mse"] = squares / count;
    state.counters["texels"] = static_cast<double>(texels) / count;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
    using namespace tessera;
    benchmark::Initialize(&argc, argv);
    const auto names = situations(16, 16);
    std::vector<std::unique_ptr<View>> views;
    for (std::size_t i = 0; i < names.size(); ++i) {
        views.push_back(std::make_unique<View>(i));
        for (const FootprintFilter& filter : compared_filters())
            benchmark::RegisterBenchmark((std::string{names[i].name} + "/" + name_of(filter)).c_str(),
                                         [filter, view = views.back().get()](benchmark::State& state) {
                                             sample(state, filter, *view);
                                         });
    }
    benchmark::RunSpecifiedBenchmarks();
}
