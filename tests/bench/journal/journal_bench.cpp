// Durable edits per second with 16 clients, each of which sends its next edit when the last one is answered
// (at least 5,000 asked, 99 of 100 within 20 ms), beside what the disk does bare: one write and one
// fdatasync.
#include <algorithm>
#include <future>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <unistd.h>

#include "server/journal/journal_wait.h"
#include "server/journal/open_journal.h"
#include "tests/support/temporary_folder.h"

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t edit_bytes = 200;

double milliseconds_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

void report(benchmark::State& state, std::vector<double>& latencies) {
    std::sort(latencies.begin(), latencies.end());
    const auto share = [&](std::size_t of_1000) { return latencies[latencies.size() * of_1000 / 1000]; };
    state.counters["p50_ms"] = share(500);
    state.counters["p99_ms"] = share(990);
    state.counters["max_ms"] = latencies.back();
    state.SetItemsProcessed(static_cast<std::int64_t>(latencies.size()));
}

/// What there is no way below.
void bare_fdatasync(benchmark::State& state) {
    const tests::TemporaryFolder folder;
    const int file = ::open((folder.path / "log").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
    const std::string page(4096, 'x');
    // Like the journal's log: written over, not made longer
    for (int i = 0; i < 1000; ++i) {
        if (::write(file, page.data(), page.size()) < 0) return state.SkipWithError("cannot write");
    }
    ::fsync(file);
    std::vector<double> latencies;
    off_t at = 0;
    for (auto _ : state) {
        const auto begin = Clock::now();
        if (::pwrite(file, page.data(), page.size(), at) < 0 || ::fdatasync(file) != 0)
            return state.SkipWithError("cannot write");
        latencies.push_back(milliseconds_since(begin));
        at = (at + 4096) % (1000 * 4096);
    }
    ::close(file);
    report(state, latencies);
}
BENCHMARK(bare_fdatasync)->UseRealTime()->MinTime(2);

/// One client, which sends edit after edit; its handlers run on the journal's thread.
struct Client {
    Journal& journal;
    const int count;
    std::promise<void> done{};
    std::vector<double> latencies{};
    bool lost = false;

    void send() {
        Append edit{random_id(), std::string(edit_bytes, 'x'), 0, {}};
        journal.append(std::move(edit), [this, begin = Clock::now()](const AppendOutcome& outcome) {
            latencies.push_back(milliseconds_since(begin));
            if (!std::holds_alternative<Accepted>(outcome)) lost = true;
            if (static_cast<int>(latencies.size()) < count)
                send();
            else
                done.set_value();
        });
    }
    static EditId random_id() {
        static std::uint64_t counter = 0;  // on one thread but for the first of each client
        EditId id;
        const std::uint64_t halves[2] = {mix(++counter), mix(~counter)};
        std::memcpy(id.bytes.data(), halves, sizeof halves);
        return id;
    }
};

void durable_edits(benchmark::State& state) {
    const tests::TemporaryFolder folder;
    SilentProgress progress;
    JournalOptions options;
    options.scene = "bench";
    const bool in_memory = state.range(1) != 0;
    auto opened = in_memory ? Result<std::unique_ptr<Journal>>{memory_journal(options)}
                            : open_journal(folder.path, options, progress);
    if (!opened) return state.SkipWithError(opened.error().detail.c_str());
    std::vector<double> latencies;
    for (auto _ : state) {
        std::vector<std::unique_ptr<Client>> clients;
        for (int i = 0; i < state.range(0); ++i) clients.emplace_back(new Client{**opened, 250});
        for (const auto& client : clients) client->send();
        for (const auto& client : clients) {
            client->done.get_future().wait();
            if (client->lost) return state.SkipWithError("an edit was not accepted");
            latencies.insert(latencies.end(), client->latencies.begin(), client->latencies.end());
        }
    }
    report(state, latencies);
}
BENCHMARK(durable_edits)
    ->ArgNames({"clients", "memory"})
    ->Args({1, 0})
    ->Args({16, 0})
    ->Args({256, 0})
    ->Args({16, 1})
    ->UseRealTime()
    ->MinTime(3);

/// How long a server with a long history takes until it is ready, and following all of it.
void open_and_follow(benchmark::State& state) {
    const tests::TemporaryFolder folder;
    SilentProgress progress;
    JournalOptions options;
    options.scene = "bench";
    const auto edits = static_cast<std::uint64_t>(state.range(0));
    {
        auto journal = open_journal(folder.path, options, progress).value();
        for (std::uint64_t n = 0; n < edits; n += 1000) {
            std::vector<Append> batch;
            for (int i = 0; i < 1000; ++i)
                batch.push_back({Client::random_id(), std::string(edit_bytes, 'x'), 0, {}});
            append_and_wait(*journal, std::move(batch));
        }
    }
    double open_ms = 0, follow_ms = 0;
    for (auto _ : state) {
        auto begin = Clock::now();
        auto journal = open_journal(folder.path, options, progress).value();
        open_ms = milliseconds_since(begin);
        begin = Clock::now();
        std::uint64_t count = 0;
        for_each_edit(*journal, 1, edits, [&](const Edit&) { return ++count > 0; });
        follow_ms = milliseconds_since(begin);
        if (count != edits) return state.SkipWithError("edits are missing");
    }
    state.counters["open_ms"] = open_ms;
    state.counters["follow_ms"] = follow_ms;
}
BENCHMARK(open_and_follow)->Arg(100'000)->Iterations(1)->UseRealTime();

}  // namespace
}  // namespace tessera

BENCHMARK_MAIN();
