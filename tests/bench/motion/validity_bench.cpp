// What it costs to tell in which steps a page stays the same, against the page's evaluation, one core.
//   build/release/bin/validity_bench
// prints the median time of a page of codes at each level, of telling its interval, and that in percent of
// the page. Returns 1 if it is more than 5 percent anywhere.
#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include <google/protobuf/util/json_util.h>

#include "server/blocks/animation_op.h"
#include "server/blocks/plan.h"
#include "server/pattern/pattern_texture.h"
#include "server/pattern/targeted_texture.h"
#include "tests/support/made_patterns.h"

namespace tessera {
namespace {

constexpr double most_percent = 5;
constexpr int runs = 41;

class MadeFiles final : public BlockFiles {
  public:
    Result<PatternImages> read_patterns(const std::string&, const proto::PatternSet&) override {
        return made_patterns(16, 4, 1, true);
    }
    Result<StoredMap> read_map(const std::string&, const std::string&) override {
        StoredMap map{1024, 1024, {}, StoredMap::Edge::wrap, 0, 0, 0};
        for (std::int64_t i = 0; i < 1024 * 1024; ++i)
            map.values.own().push_back(hash(3, stream("map"), i, 0) % 4 == 0 ? 20 : 5000);
        return map;
    }
    Result<std::shared_ptr<const Texture>> read_exchange(const std::string&, const proto::Block&) override {
        return std::shared_ptr<const Texture>{};
    }
};

Plan plan_of(const std::string& animation) {
    proto::Pattern message;
    const std::string json =
        R"({"blocks": [
      {"name": "set", "pattern_set": {"image": "a.png", "side_texels": 16}},
      {"name": "cells", "virtual_tile_map": {"cell_texels": 16}},
      {"name": "frames", "animation_sequence": {"frames": [{"pattern": 0}, {"pattern": 1}, {"pattern": 2, "steps": 20}, {"pattern": 3}]}},
      {"name": "phase", "virtual_indirection_map": {"grid": "cells", "count": 65536}},)" +
        animation +
        R"(, {"name": "t", "reference_texture": {"patterns": "set", "grid": "cells", "index": {"block": "x"}}}]})";
    if (!google::protobuf::util::JsonStringToMessage(json, &message).ok()) std::abort();
    MadeFiles files;
    auto plan = compile_plan(message, files);
    if (!plan) {
        std::fprintf(stderr, "%s\n", plan.error().detail.c_str());
        std::exit(2);
    }
    return std::move(*plan);
}

/// Microseconds of this thread, the median of many runs.
template <class Run>
double median_of(const Run& run) {
    const auto now = [] {
        timespec time{};
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) / 1e3;
    };
    std::vector<double> times;
    for (int i = 0; i < runs; ++i) {
        const double begun = now();
        run(i);
        times.push_back(now() - begun);
    }
    std::nth_element(times.begin(), times.begin() + runs / 2, times.end());
    return times[runs / 2];
}

Step any_step(int page) { return 1000 + 7 * page; }

const char* kind_of(const Validity& validity) {
    return validity.is_static() ? "static" : validity.until - validity.from == 1 ? "a step" : "some steps";
}

/// Cells that the clock drives. Returns whether it keeps the limit.
bool measure(const char* name, const std::string& animation) {
    const Plan plan = plan_of(animation);
    const auto texture = make_pattern_texture(plan);
    const ReferencePlan& cells = std::get<ReferencePlan>(plan.textures.back().what);
    bool kept = true;
    for (const std::uint8_t level : {std::uint8_t{0}, std::uint8_t{2}, std::uint8_t{4}, std::uint8_t{6}}) {
        Rgba8Image out;
        Validity validity;
        const double page = median_of([&](int i) {
            TexelRegion region = region_of({level, static_cast<std::uint32_t>(i), 3});
            region.step = any_step(i);
            validity = texture->evaluate(region, Budget{}, out)->validity;
        });
        const int side_log2 = 8 + level - 4;  // log2 of the cells along a page
        std::vector<std::int32_t> patterns(std::size_t{1} << side_log2);
        const auto decide = [&](int i, bool with) {
            Validity met;
            const std::int64_t x = std::int64_t{i} << side_log2, y = std::int64_t{3} << side_log2;
            for (std::int64_t row = 0; row < std::int64_t{1} << side_log2; ++row)
                for (std::size_t from = 0; from < patterns.size(); from += 4096) {
                    const auto count =
                        static_cast<std::int32_t>(std::min<std::size_t>(4096, patterns.size() - from));
                    cells.program->patterns({.x = x + static_cast<std::int64_t>(from),
                                             .y = y + row,
                                             .count = count,
                                             .step = any_step(i),
                                             .validity = with ? &met : nullptr},
                                            patterns.data() + from);
                }
        };
        const double without = median_of([&](int i) { decide(i, false); });
        const double with = median_of([&](int i) { decide(i, true); });
        const double percent = 100 * std::max(0.0, with - without) / page;
        kept &= percent <= most_percent;
        std::printf("%-16s level %d  page %8.1f us  interval %7.2f us  %5.2f %% of the page  %s\n", name,
                    int{level}, page, with - without, percent, kind_of(validity));
    }
    return kept;
}

/// Balls that cross the pages that are measured, in `steps` each, one in front of the other; and one that
/// never comes near.
std::vector<MovingTarget> balls(int level, int count, std::uint32_t steps) {
    const std::int64_t page = std::int64_t{256} << level, y = 3 * page + page / 2;
    const auto ball = [&](std::int64_t ahead, std::int64_t at, std::int64_t down) {
        const std::array<MovingTarget::Leg, 2> legs{
            {{{ahead, at}, 50 * steps}, {{50 * page + ahead, at + down}, 50 * steps}}};
        return MovingTarget{legs, 0};
    };
    std::vector<MovingTarget> all{ball(0, -900 * page, 0)};
    for (std::int64_t i = 0; i < count; ++i) all.push_back(ball(i * 100, y + i * 40, 40 - 90 * i));
    return all;
}

/// Cells that look at targets: the interval of a page is asked as a whole. `ahead`: pages that a ball has
/// still to go to each. Returns whether it keeps the limit.
bool measure_targets(const char* name, int count, std::uint32_t steps, double ahead) {
    const Plan plan = plan_of(R"({"name": "x", "animation_map": {"sequence": "frames",
        "target_distance": {"near_texels": 30, "far_texels": 700}}})");
    const auto pattern = make_pattern_texture(plan);
    const TargetLaw& law = plan.target_laws.front();
    const auto step_of = [&](int page) {
        return static_cast<Step>((page + 0.5 - ahead) * static_cast<double>(steps));
    };
    bool kept = true;
    for (const std::uint8_t level :
         {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{4}, std::uint8_t{6}}) {
        const std::vector<MovingTarget> targets = balls(level, count, steps);
        const auto texture = make_targeted_texture(pattern, plan, targets);
        const TargetDistance distances{law.frames->line, law.near, law.far, targets};
        Rgba8Image out;
        Validity validity;
        const double page = median_of([&](int i) {
            TexelRegion region = region_of({level, static_cast<std::uint32_t>(i), 3});
            region.step = step_of(i);
            validity = texture->evaluate(region, Budget{}, out)->validity;
        });
        // One takes less than it takes to read the clock
        constexpr int times = 16;
        const double interval =
            median_of([&](int i) {
                const std::int64_t side = std::int64_t{256} << level, cells = side / 16;
                const MotionLattice middles{{i * side + 8, 3 * side + 8}, 16, cells, cells};
                for (int time = 0; time < times; ++time) {
                    const auto rest = distances.rest_of(middles, step_of(i));
                    if (rest) continue;
                    Validity met;
                    distances.narrow(middles, step_of(i), met);
                }
            }) /
            times;
        const double percent = 100 * interval / page;
        kept &= percent <= most_percent;
        std::printf("%-16s level %d  page %8.1f us  interval %7.2f us  %5.2f %% of the page  %s\n", name,
                    int{level}, page, interval, percent, kind_of(validity));
    }
    return kept;
}

}  // namespace
}  // namespace tessera

int main() {
    using tessera::measure, tessera::measure_targets;
    const std::string rest =
        R"({"name": "rest", "virtual_random_map": {"grid": "cells", "from": 0, "to": 2000}},)";
    const std::string board =
        R"({"name": "board", "explicit_indirection_map": {"grid": "cells", "image": "b.png"}},)";
    const auto animated = [](const std::string& value) {
        return R"({"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": )" +
               value + "}}";
    };
    bool kept = measure("random rests", rest + animated(R"({"block": "rest"})"));
    kept &= measure("a board", board + animated(R"({"block": "board"})"));
    kept &= measure_targets("a ball comes", 1, 50, 8);
    kept &= measure_targets("a ball is there", 1, 50, 0);
    kept &= measure_targets("three balls", 3, 50, 0);
    // Their pages stay longer, and are asked for less often
    static_cast<void>(measure_targets("a slow one", 1, 5000, 0));
    static_cast<void>(measure_targets("three slow ones", 3, 5000, 0));
    kept &= measure("all at rest", animated(R"({"integer": "1000000000"})"));
    return kept ? 0 : 1;
}
