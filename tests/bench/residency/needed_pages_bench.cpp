// What a frame costs the planner before anything is asked for: the walk over the view, by filter.
#include <benchmark/benchmark.h>

#include "client/residency/needed_pages.h"

namespace {

using namespace tessera;

constexpr Sampling samplings[] = {{Sampling::Kind::isotropic},
                                  {Sampling::Kind::nearest_level},
                                  {Sampling::Kind::anisotropic},
                                  {Sampling::Kind::supersampled, 4},
                                  {Sampling::Kind::line_integral, 1, 6}};

void walk(benchmark::State& state) {
    const Sampling sampling = samplings[static_cast<std::size_t>(state.range(0))];
    const Camera camera{.ground = {1'234'567'890, 987'654'321, 0.5, 0.5},
                        .height_texels = 750,
                        .yaw_degrees = 33,
                        .pitch_degrees = static_cast<double>(-state.range(1))};
    const PlaneView view{camera, 800, 700};
    std::size_t pages = 0;
    for (auto _ : state) pages = needed_pages(view, Extent{30}, 0, sampling).size();
    if (pages < 8) return state.SkipWithError("hardly a page");
    state.counters["pages"] = static_cast<double>(pages);
}
BENCHMARK(walk)
    ->ArgNames({"filter", "pitch"})
    ->ArgsProduct({{0, 1, 2, 3, 4}, {12, 40, 80}})
    ->Unit(benchmark::kMicrosecond);

/// Of hills, which hide each other. Their mesh is kept from one walk to the next here: the camera stands
/// still.
void walk_terrain(benchmark::State& state) {
    const Sampling sampling = samplings[static_cast<std::size_t>(state.range(0))];
    const Camera camera{.ground = {1'234'567'890, 987'654'321, 0.5, 0.5},
                        .height_texels = 750,
                        .yaw_degrees = 33,
                        .pitch_degrees = static_cast<double>(-state.range(1))};
    const Surface hills{.kind = Surface::Kind::terrain};
    std::size_t pages = 0;
    for (auto _ : state) pages = needed_pages({camera, 800, 700, hills}, Extent{30}, 0, sampling).size();
    if (pages < 8) return state.SkipWithError("hardly a page");
    state.counters["pages"] = static_cast<double>(pages);
}
BENCHMARK(walk_terrain)
    ->ArgNames({"filter", "pitch"})
    ->ArgsProduct({{0, 2, 4}, {12, 40}})
    ->Unit(benchmark::kMicrosecond);

void mesh_terrain(benchmark::State& state) {
    const Camera camera{.ground = {1'234'567'890, 987'654'321, 0.5, 0.5},
                        .height_texels = 750,
                        .yaw_degrees = 33,
                        .pitch_degrees = static_cast<double>(-state.range(0))};
    const Surface hills{.kind = Surface::Kind::terrain};
    std::size_t pieces = 0;
    for (auto _ : state) pieces = PlaneView{camera, 800, 700, hills}.pieces().size();
    state.counters["pieces"] = static_cast<double>(pieces);
}
BENCHMARK(mesh_terrain)->ArgName("pitch")->Arg(12)->Arg(40)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
