// Durable moves of sprites per second with 16 clients, each of which sends its next move when the last one is
// answered (at least 5,000 asked, 99 of 100 within 20 ms), in scenes of few sprites and of a million; and
// what a page under a few of them costs beside the same page in a scene of few.
#include <algorithm>
#include <future>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "server/edits/live_scene.h"
#include "server/journal/open_journal.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/server/edits/made_scene.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

/// On a grid of 64 texels, from texel 0 on.
ScenePtr scene_of(std::int64_t sprites) {
    auto scene = std::make_shared<Scene>(*made_scene());
    for (std::int64_t n = 0; n < sprites; ++n) {
        Sprite sprite;
        sprite.id = static_cast<SpriteId>(n + 1);
        sprite.x = (n % 1024 * 64 + 20) * sprite_units;
        sprite.y = (n / 1024 * 64 + 20) * sprite_units;
        sprite.side_texels = 16;
        if (!scene->sprites.place(sprite)) std::abort();
    }
    scene->texture = make_sprite_texture(scene->ground, scene->sprite_images, scene->sprites);
    return scene;
}

/// Drags one sprite; its handlers run on the journal's thread.
struct Client {
    LiveScene& scene;
    const SpriteId sprite;
    const std::size_t count;
    std::promise<void> done{};
    std::vector<double> latencies{};
    bool lost = false;

    void send() {
        const double at = 20 + static_cast<double>(latencies.size() % 16);
        const auto row = static_cast<double>((sprite - 1) / 1024),
                   column = static_cast<double>((sprite - 1) % 1024);
        scene.edit(moving(sprite, column * 64 + at, row * 64 + at), [this, begin = Clock::now()](
                                                                        const EditOutcome& outcome) {
            latencies.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
            lost = lost || !std::holds_alternative<proto::EditAnswer>(outcome);
            if (latencies.size() < count)
                send();
            else
                done.set_value();
        });
    }
};

void durable_moves(benchmark::State& state) {
    const tests::TemporaryFolder folder;
    SilentProgress progress;
    JournalOptions options;
    options.scene = "made";
    auto journal = open_journal(folder.path, options, progress);
    if (!journal) return state.SkipWithError(journal.error().detail.c_str());
    auto live = LiveScene::open(scene_of(state.range(0)), std::move(*journal), progress);
    if (!live) return state.SkipWithError(live.error().detail.c_str());
    std::vector<double> latencies;
    for (auto _ : state) {
        std::vector<std::unique_ptr<Client>> clients;
        for (SpriteId sprite = 1; sprite <= 16; ++sprite)
            clients.emplace_back(new Client{**live, sprite * 50, 250});
        for (const auto& client : clients) client->send();
        for (const auto& client : clients) {
            client->done.get_future().wait();
            if (client->lost) return state.SkipWithError("a move was not accepted");
            latencies.insert(latencies.end(), client->latencies.begin(), client->latencies.end());
        }
    }
    std::sort(latencies.begin(), latencies.end());
    state.counters["p50_ms"] = latencies[latencies.size() / 2];
    state.counters["p99_ms"] = latencies[latencies.size() * 99 / 100];
    state.counters["sprites_MB"] = static_cast<double>((*live)->now()->sprites.memory_bytes()) / 1e6;
    state.SetItemsProcessed(static_cast<std::int64_t>(latencies.size()));
}
BENCHMARK(durable_moves)->ArgName("sprites")->Arg(1000)->Arg(1'000'000)->UseRealTime()->MinTime(3);

/// 16 sprites under the page, however many there are elsewhere.
void page_under_sprites(benchmark::State& state) {
    const ScenePtr scene = scene_of(state.range(0));
    LinearImage out;
    for (auto _ : state)
        if (!scene->texture->evaluate({.level = 0, .width = 256, .height = 256}, {}, out))
            return state.SkipWithError("no page");
}
BENCHMARK(page_under_sprites)->ArgName("sprites")->Arg(2000)->Arg(1'000'000)->UseRealTime();

}  // namespace
}  // namespace tessera

BENCHMARK_MAIN();
