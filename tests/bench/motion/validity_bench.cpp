// What it costs to tell in which steps a page stays the same, against the page's evaluation, one core.
//   build/release/bin/validity_bench [PART OF A ROW'S NAME]
// prints the median time of a page of codes at each level, of telling its interval, and that in percent of
// the page; then in percent of all pages that the interval stands for, which is one in each of its steps: for
// whatever may change in any of those is looked at, so that an interval of a hundred steps takes longer than
// one of a step, and spares a hundred pages. Returns 1 if an interval takes more than 5 percent of the page
// anywhere.
// Of the message board, which scrolls, everything that an interval costs is counted, frames and shifts, by a
// plan of its own that knows no more than a page does: "played" is a window of eight pages by one over the
// steps, each page once for each of its intervals, as a server does; "alone" are pages far from each other in
// place and time.
#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <google/protobuf/util/json_util.h>

#include "server/blocks/animation_op.h"
#include "server/blocks/plan.h"
#include "server/pattern/pattern_texture.h"
#include "server/pattern/scroll_watch.h"
#include "server/pattern/targeted_texture.h"
#include "server/scene/pattern_files.h"
#include "server/scenes/moving_scenes.h"
#include "tests/support/made_patterns.h"
#include "tests/support/temporary_folder.h"

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
        std::vector<std::int32_t> values;
        for (std::int64_t i = 0; i < 1024 * 1024; ++i)
            values.push_back(hash(3, stream("map"), i, 0) % 4 == 0 ? 20 : 5000);
        return StoredMap{1024, 1024, values, StoredMap::Edge::wrap, 0, 0, 0};
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

/// Of its processor.
double thread_microseconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) / 1e3;
}

/// What reading that takes: about half a microsecond, which is left out of every time told.
double clock_microseconds() {
    static const double least = [] {
        double found = 1e9;
        for (int i = 0; i < 2000; ++i) {
            const double begun = thread_microseconds();
            found = std::min(found, thread_microseconds() - begun);
        }
        return found;
    }();
    return least;
}
double microseconds_since(double begun) { return thread_microseconds() - begun - clock_microseconds(); }

/// Microseconds of this thread, the median of many runs.
template <class Run>
double median_of(const Run& run) {
    std::vector<double> times;
    for (int i = 0; i < runs; ++i) {
        const double begun = thread_microseconds();
        run(i);
        times.push_back(microseconds_since(begun));
    }
    std::nth_element(times.begin(), times.begin() + runs / 2, times.end());
    return times[runs / 2];
}

Step any_step(int page) { return 1000 + 7 * page; }

/// How many pages an interval stands for, at most so many: who plays asks for one in each of its steps.
double steps_of(const Validity& validity) {
    constexpr double most = 1000;
    if (validity.is_static() || validity.from == always || validity.until == never) return most;
    return std::min(most, static_cast<double>(validity.until - validity.from));
}

/// What intervals took, of pages that took so long; they stood for `steps` of these on average. Returns
/// whether that keeps the limit.
bool print_row(const char* name, int level, double page, double interval, double steps) {
    const double percent = 100 * std::max(0.0, interval) / page;
    std::printf(
        "%-16s level %d  page %8.1f us  interval %7.2f us  %5.2f %% of the page, %4.2f %% of the %.1f that "
        "it stands for\n",
        name, level, page, interval, percent, percent / steps, steps);
    return percent <= most_percent;
}

/// Cells that the clock drives. Returns whether it keeps the limit.
bool measure(const char* name, const std::string& animation) {
    const Plan plan = plan_of(animation);
    const auto texture = make_pattern_texture(plan);
    const ReferencePlan& cells = std::get<ReferencePlan>(plan.textures.back().what);
    bool kept = true;
    for (const std::uint8_t level : {std::uint8_t{0}, std::uint8_t{2}, std::uint8_t{4}, std::uint8_t{6}}) {
        Rgba8Image out;
        double steps = 0;
        const double page = median_of([&](int i) {
            TexelRegion region = region_of({level, static_cast<std::uint32_t>(i), 3});
            region.step = any_step(i);
            steps += steps_of(texture->evaluate(region, Budget{}, out)->validity) / runs;
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
        kept &= print_row(name, int{level}, page, with - without, steps);
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
        double steps_stood_for = 0;
        const double page = median_of([&](int i) {
            TexelRegion region = region_of({level, static_cast<std::uint32_t>(i), 3});
            region.step = step_of(i);
            steps_stood_for += steps_of(texture->evaluate(region, Budget{}, out)->validity) / runs;
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
        kept &= print_row(name, int{level}, page, interval, steps_stood_for);
    }
    return kept;
}

/// The sample message board, compiled.
class MessageBoard {
  public:
    MessageBoard() : plan_{compile()}, texture_{make_pattern_texture(plan_)}, alone_{compile()} {}

    /// What a page, and its interval alone, took so far. Both know the same of the board: intervals are told
    /// by a plan of their own, which has met the same pages and no others.
    struct Times {
        double pages = 0, intervals = 0, steps = 0;
        std::size_t count = 0;
        bool print(const char* name, int level) const {
            const auto all = static_cast<double>(count);
            return print_row(name, level, pages / all, intervals / all, steps / all);
        }
    };
    Validity page(std::uint8_t level, std::int64_t x, std::int64_t y, Step step, Times& times) {
        TexelRegion region = region_of({level, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)});
        region.step = step;
        const double begun = thread_microseconds();
        const Validity valid = texture_->evaluate(region, Budget{}, out_)->validity;
        times.pages += microseconds_since(begun);
        const int side_log2 = 8 + level - 4;
        const CellProgram& cells = *std::get<ReferencePlan>(alone_.textures.back().what).program;
        const CellBlock block{.x = x << side_log2,
                              .y = y << side_log2,
                              .width = 1 << side_log2,
                              .height = 1 << side_log2,
                              .step = step};
        const auto decide = [&](Validity* frames, ScrollWatch* watch) {
            patterns_.resize(std::size_t{1} << side_log2);
            const double from = thread_microseconds();
            for (std::int32_t i = 0; i < block.height; ++i) {
                cells.patterns(
                    {.x = block.x, .y = block.y + i, .count = block.width, .step = step, .validity = frames},
                    patterns_.data());
                if (watch != nullptr)
                    watch->see(block.x, block.y + i, std::span<const std::int32_t>{patterns_});
            }
            return microseconds_since(from);
        };
        // That the map's entries come from memory is no cost of the interval: a page reads them anyway
        decide(nullptr, nullptr);
        ScrollWatch watch{cells, region, 0, block.x, block.y, block.width, block.height};
        double with = decide(watch.frames(), &watch), without = decide(nullptr, nullptr);
        // The least of some: a whole block takes long against what is told of it
        for (int again = 0; again < 2; ++again) {
            ScrollWatch another{cells, region, 0, block.x, block.y, block.width, block.height};
            with = std::min(with, decide(another.frames(), &another));
            without = std::min(without, decide(nullptr, nullptr));
        }
        double told = with - without;
        const double last = thread_microseconds();
        const Validity again = watch.interval();
        told += microseconds_since(last);
        times.intervals += told;
        times.steps += steps_of(valid);
        if (again != valid) std::abort();
        ++times.count;
        return valid;
    }

  private:
    static Plan compile() {
        const tests::TemporaryFolder folder;
        const std::filesystem::path path = folder.path / "message-board";
        std::filesystem::create_directories(path);
        const PaintedScene painted = paint_moving_scene("message-board");
        for (const PaintedFile& file : painted.files)
            std::ofstream{path / file.name, std::ios::binary}.write(
                reinterpret_cast<const char*>(file.bytes.data()), std::ssize(file.bytes));
        PatternFiles files{path};
        auto plan = compile_plan(painted.scene.pattern(), files);
        if (!plan) std::abort();
        return std::move(*plan);
    }

    Plan plan_;
    std::shared_ptr<const Texture> texture_;
    Plan alone_;
    Rgba8Image out_;
    std::vector<std::int32_t> patterns_;
};

/// Above the letters, at their rim, and through their middle.
constexpr std::int64_t board_left = 2048 + 3000;
constexpr std::array<std::int64_t, 3> board_rows{7424 + 90, 7424 + 660, 7424 + 768};

/// Played once round, as a server does for a window of eight pages by one: each page once for each of its
/// intervals. Returns whether what these take together keeps the limit.
bool measure_board_played(const char* name) {
    constexpr std::int64_t wide = 8;
    bool kept = true;
    for (const std::uint8_t level : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{4}}) {
        const Step steps = level < 2 ? 1576 : 160;
        const int side_log2 = 8 + level - 4;
        MessageBoard board;
        MessageBoard::Times times;
        for (const std::int64_t row : board_rows) {
            // What is worked out once for the map counts with no page
            MessageBoard::Times first;
            for (std::int64_t i = 0; i < wide; ++i)
                board.page(level, ((board_left + 6000) >> side_log2) + i, row >> side_log2, 800, first);
            std::array<Validity, wide> valid;
            valid.fill({0, 0});
            for (Step step = 0; step < steps; ++step)
                for (std::size_t i = 0; i < wide; ++i)
                    if (!valid[i].holds(step))
                        valid[i] = board.page(level, (board_left >> side_log2) + static_cast<std::int64_t>(i),
                                              row >> side_log2, step, times);
        }
        // Of those that are begun or ended beyond what is played, only what is played
        times.steps = static_cast<double>(board_rows.size()) * static_cast<double>(wide * steps);
        kept &= times.print(name, int{level});
    }
    return kept;
}

/// Pages far from each other in place and time: nobody knows anything of their cells.
bool measure_board_alone(const char* name) {
    bool kept = true;
    for (const std::uint8_t level : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{4}}) {
        const int side_log2 = 8 + level - 4;
        MessageBoard board;
        MessageBoard::Times times;
        for (const std::int64_t row : board_rows)
            for (int i = 0; i < (level < 4 ? 200 : 20); ++i) {
                // The first of them finds out what there is to know of the map
                MessageBoard::Times first;
                board.page(level, (board_left + 800 * i) >> side_log2, row >> side_log2, 7919 * i,
                           i == 0 ? first : times);
            }
        kept &= times.print(name, int{level});
    }
    return kept;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
    using namespace tessera;
    const std::string rest =
        R"({"name": "rest", "virtual_random_map": {"grid": "cells", "from": 0, "to": 2000}},)";
    const std::string board =
        R"({"name": "board", "explicit_indirection_map": {"grid": "cells", "image": "b.png"}},)";
    const auto animated = [](const std::string& value) {
        return R"({"name": "x", "animation_map": {"sequence": "frames", "phase": {"block": "phase"}, "rest": )" +
               value + "}}";
    };
    struct Row {
        const char* name;
        std::function<bool(const char* name)> measure;
    };
    const std::array rows{
        Row{"random rests",
            [&](auto name) { return measure(name, rest + animated(R"({"block": "rest"})")); }},
        Row{"a board", [&](auto name) { return measure(name, board + animated(R"({"block": "board"})")); }},
        Row{"a board, played", measure_board_played},
        Row{"a board, alone", measure_board_alone},
        Row{"a ball comes", [](auto name) { return measure_targets(name, 1, 50, 8); }},
        Row{"a ball is there", [](auto name) { return measure_targets(name, 1, 50, 0); }},
        Row{"three balls", [](auto name) { return measure_targets(name, 3, 50, 0); }},
        Row{"a slow one", [](auto name) { return measure_targets(name, 1, 5000, 0); }},
        Row{"three slow ones", [](auto name) { return measure_targets(name, 3, 5000, 0); }},
        Row{"all at rest",
            [&](auto name) { return measure(name, animated(R"({"integer": "1000000000"})")); }},
    };
    const std::string only = argc > 1 ? argv[1] : "";
    std::printf("reading the clock takes %.2f us, left out of all times\n", clock_microseconds());
    bool kept = true;
    for (const Row& row : rows)
        if (std::string{row.name}.find(only) != std::string::npos) kept &= row.measure(row.name);
    return kept ? 0 : 1;
}
