// Content exchange against a cold memcpy of a page: 64 patches of 25 contents on a 512² tile, one core.
//   build/release/bin/evaluate_bench
// prints for each level the time of one 256² RGBA page and its ratio to the memcpy of the same run.
#include <algorithm>
#include <cstring>
#include <iostream>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "server/texture/exchange.h"
#include "server/texture/kernels.h"
#include "shared/math/hash.h"
#include "tests/support/synthetic_asset.h"

namespace tessera {
namespace {

constexpr std::size_t page_bytes = 256 * 256 * 4;

const Texture& texture() {
    static const auto made = make_exchange_texture(
        tests::make_synthetic_asset({.tile_side = 512, .patches = 64, .contents = 25, .blend_texels = 8}),
        {.seed = 1});
    return *made;
}

/// A page of a level that no earlier iteration asked for: what a request that misses every cache costs.
TexelRegion fresh_page(std::uint8_t level, std::int64_t i) {
    const auto pages = std::uint32_t{1} << std::min(30 - level, 24);
    const auto at = [&](std::uint64_t axis) {
        return std::int64_t{uniform_below(hash(1, stream("bench page", axis), i, level), pages)} * 256;
    };
    return {level, at(0), at(1), 256, 256};
}

/// A benchmark refuses to time a wrong answer: the page must be the reduction of its children.
bool right(std::uint8_t level) {
    if (level == 0) return true;  // level 0 is what the others are held to
    const TexelRegion region{level, 3 * 256, 5 * 256, 64, 64};
    const TexelRegion children{static_cast<std::uint8_t>(level - 1), 6 * 256, 10 * 256, 128, 128};
    LinearImage page, below;
    if (!texture().evaluate(region, Budget{}, page) || !texture().evaluate(children, Budget{}, below))
        return false;
    for (std::int32_t y = 0; y < 64; ++y)
        for (std::int32_t x = 0; x < 64; ++x)
            for (std::int32_t c = 0; c < 3; ++c) {
                const float mean =
                    0.25F * (below.row(2 * y)[8 * x + c] + below.row(2 * y)[8 * x + 4 + c] +
                             below.row(2 * y + 1)[8 * x + c] + below.row(2 * y + 1)[8 * x + 4 + c]);
                if (std::abs(mean - page.row(y)[4 * x + c]) > 0.02 * code_in_linear) return false;
            }
    return true;
}

void evaluate_page(benchmark::State& state) {
    const auto level = static_cast<std::uint8_t>(state.range(0));
    if (!right(level)) return state.SkipWithError("the page is not the reduction of its children");
    Rgba8Image page;
    std::int64_t i = 0;
    for (auto _ : state) {
        if (!texture().evaluate(fresh_page(level, i++), Budget{}, page))
            return state.SkipWithError("not evaluated");
        benchmark::DoNotOptimize(page.bytes.data());
    }
    state.SetItemsProcessed(state.iterations() * 256 * 256);  // texels a second
}

void cold_memcpy(benchmark::State& state) {
    // 1024 pages each way: far more than the caches hold, visited in an order that no prefetcher guesses
    constexpr std::size_t pages = 1024;
    static std::vector<std::uint8_t> from(pages * page_bytes, 1), to(pages * page_bytes, 2);
    std::size_t i = 0;
    for (auto _ : state) {
        const std::size_t at = (i++ * 389 % pages) * page_bytes;
        std::memcpy(to.data() + at, from.data() + at, page_bytes);
        benchmark::ClobberMemory();
    }
}

/// Prints each median as a ratio to the memcpy's of the same run.
class RatioReporter : public benchmark::ConsoleReporter {
  public:
    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs) {
            if (run.error_occurred || run.aggregate_name != "median") continue;
            if (run.benchmark_name().starts_with("cold_memcpy"))
                memcpy_time_ = run.GetAdjustedCPUTime();
            else if (memcpy_time_ > 0)
                std::cout << "  " << run.benchmark_name() << " = " << run.GetAdjustedCPUTime() / memcpy_time_
                          << " × a cold memcpy of the page\n";
        }
    }

  private:
    double memcpy_time_ = 0;
};

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
    using namespace tessera;
    benchmark::Initialize(&argc, argv);
    std::cout << "kernels: " << kernels().name << "\n" << texture().description();
    const auto repeat = [](benchmark::internal::Benchmark* b) {
        b->Repetitions(7)->ReportAggregatesOnly()->MinTime(0.05)->Unit(benchmark::kMicrosecond);
    };
    repeat(benchmark::RegisterBenchmark("cold_memcpy", cold_memcpy));
    auto* pages = benchmark::RegisterBenchmark("evaluate_page", evaluate_page)->ArgName("level");
    for (int level = 0; level <= 20; ++level) pages->Arg(level);
    repeat(pages);
    RatioReporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
}
