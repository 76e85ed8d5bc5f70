// What an edit costs in page revisions, and what asking for a page's costs, with many edits behind it.
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "shared/revisions/page_revisions.h"

namespace tessera {
namespace {

constexpr Extent extent{20};

/// Boxes of sprites, all over the extent.
std::vector<TexelBox> sprites(std::size_t count) {
    std::mt19937_64 random{7};
    const auto below = [&random](std::int64_t most) {
        return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(most));
    };
    std::vector<TexelBox> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t x = below(extent.side_texels()), y = below(extent.side_texels()),
                           side = 16 + below(112);
        boxes.push_back({x, y, x + side, y + side});
    }
    return boxes;
}

PageRevisions revisions_of(const std::vector<TexelBox>& boxes, std::size_t memory_bytes) {
    PageRevisions revisions{memory_bytes};
    Revision revision = 0;
    for (const TexelBox& box : boxes) revisions.mark(box, ++revision);
    return revisions;
}

/// Of 300,000 edits, made once.
const PageRevisions& many_revisions() {
    static const PageRevisions revisions = revisions_of(sprites(300'000), std::size_t{1} << 30);
    return revisions;
}

/// Edits in new places, all of which are remembered one by one.
void mark_new_places(benchmark::State& state) {
    const auto boxes = sprites(static_cast<std::size_t>(state.range(0)));
    for (auto _ : state) {
        const PageRevisions revisions = revisions_of(boxes, std::size_t{1} << 30);
        state.counters["bytes_per_edit"] = double(revisions.used_bytes()) / double(boxes.size());
        benchmark::DoNotOptimize(revisions.of({0, 5, 5}, 0));
    }
    state.counters["us_per_mark"] =
        benchmark::Counter(double(state.iterations()) * double(boxes.size()) * 1e-6,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(mark_new_places)->Arg(10'000)->Arg(300'000)->Unit(benchmark::kMillisecond);

/// The same where memory is short.
void mark_with_joining(benchmark::State& state) {
    const auto boxes = sprites(300'000);
    for (auto _ : state) {
        const PageRevisions revisions = revisions_of(boxes, std::size_t{16} << 20);
        state.counters["MB"] = double(revisions.used_bytes()) * 1e-6;
    }
    state.counters["us_per_mark"] =
        benchmark::Counter(double(state.iterations()) * double(boxes.size()) * 1e-6,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(mark_with_joining)->Unit(benchmark::kMillisecond);

/// One sprite of many is dragged about; a scene keeps a copy of each state for a while.
void mark_a_drag(benchmark::State& state) {
    PageRevisions revisions = many_revisions();
    PageRevisions kept;
    Revision revision = 300'000;
    const std::size_t before = revisions.used_bytes();
    TexelBox sprite{100'000, 100'000, 100'064, 100'064};
    for (auto _ : state) {
        const TexelBox old = sprite;
        const std::int64_t dx = (revision / 97 % 2 == 0) ? 3 : -3, dy = (revision / 61 % 2 == 0) ? 2 : -2;
        sprite = {old.x0 + dx, old.y0 + dy, old.x1 + dx, old.y1 + dy};
        revisions.mark(hull(old, sprite), ++revision);
        if (state.range(0) != 0) kept = revisions;
    }
    state.counters["bytes_per_edit"] =
        (double(revisions.used_bytes()) - double(before)) / double(state.iterations());
}
BENCHMARK(mark_a_drag)->ArgName("with_copies")->Arg(0)->Arg(1);

void look_up(benchmark::State& state) {
    const auto boxes = sprites(300'000);
    const PageRevisions& revisions = many_revisions();
    const auto level = static_cast<std::uint8_t>(state.range(0));
    const auto gutter = static_cast<std::int32_t>(state.range(1));
    std::size_t i = 0;
    for (auto _ : state) {
        const TexelBox& box = boxes[i++ % boxes.size()];
        const std::int64_t side = std::int64_t{page_side_texels} << level;
        benchmark::DoNotOptimize(revisions.of(
            {level, static_cast<std::uint32_t>(box.x0 / side), static_cast<std::uint32_t>(box.y0 / side)},
            gutter));
    }
}
BENCHMARK(look_up)->ArgNames({"level", "gutter"})->ArgsProduct({{0, 5, 10, 15, 20}, {0, 16}});

/// A snapshot's part.
void save_and_load(benchmark::State& state) {
    const PageRevisions revisions = revisions_of(sprites(100'000), std::size_t{1} << 30);
    for (auto _ : state) {
        const std::string bytes = revisions.save();
        if (!PageRevisions::load(bytes, std::size_t{1} << 30)) return state.SkipWithError("cannot be loaded");
        state.counters["bytes_per_edit"] = double(bytes.size()) / 100'000;
    }
}
BENCHMARK(save_and_load)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tessera

BENCHMARK_MAIN();
