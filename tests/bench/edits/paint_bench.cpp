// From an edit to its acknowledgement, durable, in the sample scenes: a small brush on their maps (under 50
// ms asked), a change of an animation; and a move of a sprite while somebody paints, in a scene of both.
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "server/blocks/editable_map.h"
#include "server/edits/live_scene.h"
#include "server/journal/open_journal.h"
#include "server/scenes/moving_scenes.h"
#include "server/scenes/pattern_scenes.h"
#include "shared/wire/json.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/server/edits/edited_pattern.h"
#include "tests/unit/server/edits/made_scene.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

ScenePtr sample(const std::string& name) {
    static tests::TemporaryFolder folder;
    const std::filesystem::path scene = folder.path / name;
    if (!std::filesystem::exists(scene)) {
        std::filesystem::create_directories(scene);
        const PaintedScene painted = [&] {
            for (const std::string_view moving : moving_scene_names())
                if (moving == name) return paint_moving_scene(name);
            return paint_pattern_scene(name);
        }();
        std::ofstream{scene / "scene.json"} << write_json(painted.scene);
        for (const PaintedFile& file : painted.files)
            std::ofstream{scene / file.name, std::ios::binary}.write(
                reinterpret_cast<const char*>(file.bytes.data()), std::ssize(file.bytes));
    }
    return load_scene(scene).value();
}

struct Served {
    explicit Served(const ScenePtr& scene) {
        SilentProgress progress;
        JournalOptions options;
        options.scene = scene->id;
        live =
            LiveScene::open(scene, open_journal(folder.path, std::move(options), progress).value(), progress)
                .value();
    }
    /// Milliseconds until it is acknowledged.
    double edit(proto::Edit edit) const {
        std::promise<bool> done;
        const auto begin = Clock::now();
        live->edit(std::move(edit), [&](const EditOutcome& how) {
            if (const auto* refusal = std::get_if<EditRefusal>(&how))
                std::fprintf(stderr, "refused: %s\n", refusal->detail.c_str());
            done.set_value(std::holds_alternative<proto::EditAnswer>(how));
        });
        if (!done.get_future().get()) std::abort();
        return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    }
    tests::TemporaryFolder folder;
    std::unique_ptr<LiveScene> live;
};

double at_share(std::vector<double> values, double share) {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// A round brush of four entries across, at different places with different values.
proto::Edit brush(const EditableMap& map, int i) {
    proto::Edit edit = new_edit();
    proto::MapPaint& paint = *edit.add_changes()->mutable_paint_map();
    paint.set_block(map.block);
    paint.set_width(4);
    paint.set_height(4);
    paint.set_x(i * 37 % (map.map.width - 4));
    paint.set_y(i * 53 % (map.map.height - 4));
    const auto& known = map.map.values.distinct();
    paint.set_value(map.map.bounded() ? map.map.least + i % (map.map.most - map.map.least + 1)
                                      : known[static_cast<std::size_t>(i) % known.size()]);
    paint.set_mask("\xf6\x6f");
    return edit;
}

void paints(benchmark::State& state, const std::string& name) {
    const Served served{sample(name)};
    const EditableMap map = served.live->now()->editable_maps->front();
    std::vector<double> times;
    for (auto _ : state) times.push_back(served.edit(brush(map, static_cast<int>(times.size()))));
    state.counters["median ms"] = at_share(times, 0.5);
    state.counters["p95 ms"] = at_share(times, 0.95);
}
BENCHMARK_CAPTURE(paints, meadow_sand, "meadow-sand")->Iterations(30)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(paints, autumn, "autumn")->Iterations(30)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(paints, terrain, "terrain")->Iterations(30)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(paints, message_board, "message-board")->Iterations(30)->Unit(benchmark::kMillisecond);

void changes_animation(benchmark::State& state, const std::string& name, const std::string& block) {
    const Served served{sample(name)};
    std::vector<double> times;
    for (auto _ : state) {
        proto::Edit edit = new_edit();
        proto::AnimationChange& change = *edit.add_changes()->mutable_change_animation();
        change.set_block(block);
        change.set_step(10'000 + 200 * static_cast<std::int64_t>(times.size()));
        change.set_density(1.0 + static_cast<double>(times.size() % 5));
        times.push_back(served.edit(std::move(edit)));
    }
    state.counters["median ms"] = at_share(times, 0.5);
}
BENCHMARK_CAPTURE(changes_animation, message_board, "message-board", "lit")
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

/// Moves of a sprite, alone and while somebody paints without a pause.
void moves(benchmark::State& state, bool painted) {
    const EditedPattern files;
    const Served served{files.load()};
    const EditableMap map = served.live->now()->editable_maps->front();
    served.edit(placing(1, 100, 100));
    std::jthread painter;
    std::atomic<int> strokes = 0;
    if (painted)
        painter = std::jthread{[&](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                ++strokes;
                served.edit(brush(map, strokes.load()));
            }
        }};
    std::vector<double> times;
    for (auto _ : state)
        times.push_back(served.edit(moving(1, 100 + static_cast<double>(times.size() % 9), 100)));
    painter.request_stop();
    state.counters["median ms"] = at_share(times, 0.5);
    state.counters["p95 ms"] = at_share(times, 0.95);
    state.counters["strokes"] = strokes.load();
}
BENCHMARK_CAPTURE(moves, alone, false)->Iterations(200)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(moves, while_painted, true)->Iterations(200)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tessera

BENCHMARK_MAIN();
