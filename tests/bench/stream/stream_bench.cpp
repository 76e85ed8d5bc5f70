// What the stream costs, on loopback, with server and client in this process: from an edit to the new page at
// a client that follows (a median under 10 ms is asked); pages per second of the server's processor time
// beside our own HTTP; bytes around a page's texels; memory of a stream on which nothing happens.
#include <algorithm>
#include <ctime>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "tests/end_to_end/stream/live_server.h"

namespace tessera::test {
namespace {

using Case = proto::ServerMessage::MessageCase;
using Clock = std::chrono::steady_clock;

double cpu_seconds(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}
/// Of all threads but this one, which is the client's.
double server_seconds() {
    return cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
}

void edit_to_page(benchmark::State& state) {
    LiveServer live;
    StreamClient editor = live.stream(), viewer = live.stream();
    editor.hello();
    viewer.hello();
    viewer.watch(0, 0, 0, 8, 8);
    viewer.grant(1000);
    editor.send(message_of(placing(1, 100, 100)));
    editor.receive(Case::kEditDone);
    viewer.receive(Case::kInvalidation);
    std::vector<double> times;
    std::uint32_t id = 0;
    for (auto _ : state) {
        const auto at = static_cast<double>(20 + id % 200);
        const auto begun = Clock::now();
        editor.send(message_of(moving(1, at, at)));
        const auto told = viewer.receive(Case::kInvalidation);
        if (!told) return state.SkipWithError("not told");
        proto::ClientMessage message;
        StreamClient::add_ask(message, ++id, 0, 0, 0).set_least_revision(told->invalidation().revision());
        viewer.send(message);
        const auto page = viewer.receive(Case::kPage);
        if (!page || page->page().revision() < told->invalidation().revision())
            return state.SkipWithError("no new page");
        times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begun).count());
        if (!editor.receive(Case::kEditDone)) return state.SkipWithError("not acknowledged");
        if (id % 500 == 0) viewer.grant(1000);
    }
    std::sort(times.begin(), times.end());
    state.counters["p50_ms"] = times[times.size() / 2];
    state.counters["p99_ms"] = times[times.size() * 99 / 100];
}
BENCHMARK(edit_to_page)->UseRealTime()->MinTime(2);

constexpr std::uint32_t pages = 256;

void cached_pages_by_stream(benchmark::State& state) {
    LiveServer live;
    StreamClient client = live.stream();
    client.hello();
    proto::ClientMessage message;
    for (std::uint32_t id = 0; id < pages; ++id) StreamClient::add_ask(message, id, 0, id % 16, id / 16);
    message.mutable_ask()->mutable_options()->set_format("png");
    const auto round = [&] {
        client.grant(pages);
        client.send(message);
        for (std::uint32_t i = 0; i < pages; ++i)
            if (!client.receive(Case::kPage)) std::abort();
    };
    round();
    const double before = server_seconds();
    for (auto _ : state) round();
    const double spent = server_seconds() - before;
    state.SetItemsProcessed(state.iterations() * pages);
    state.counters["server_us_per_page"] = spent / static_cast<double>(state.iterations() * pages) * 1e6;
}
BENCHMARK(cached_pages_by_stream)->UseRealTime()->MinTime(2);

void cached_pages_by_http(benchmark::State& state) {
    LiveServer live;
    RawClient client = live.http();
    const auto round = [&] {
        for (std::uint32_t i = 0; i < pages; ++i) {
            const auto reply = client.get("/scenes/made/10/" + std::to_string(i % 16) + "/" +
                                          std::to_string(i / 16) + ".png");
            if (!reply || reply->status != 200) std::abort();
        }
    };
    round();
    const double before = server_seconds();
    for (auto _ : state) round();
    const double spent = server_seconds() - before;
    state.SetItemsProcessed(state.iterations() * pages);
    state.counters["server_us_per_page"] = spent / static_cast<double>(state.iterations() * pages) * 1e6;
}
BENCHMARK(cached_pages_by_http)->UseRealTime()->MinTime(2);

/// WebSocket's header is 2, 4 or 10 bytes.
std::size_t frame_bytes(std::size_t message) {
    return message + (message < 126 ? 2 : message < 65536 ? 4 : 10);
}

void bytes_around_a_page(benchmark::State& state) {
    LiveServer live;
    StreamClient client = live.stream();
    client.hello();
    client.grant(1000);
    std::size_t most = 0;
    for (auto _ : state) {
        for (const std::int64_t at : {0, 1023}) {
            proto::ClientMessage message;
            StreamClient::add_ask(message, 1000, 0, at, at);
            message.mutable_ask()->mutable_options()->set_brief(state.range(0) != 0);
            client.send(message);
            const auto page = client.receive(Case::kPage);
            if (!page) return state.SkipWithError("no page");
            most = std::max(most, frame_bytes(client.last_bytes()) - page->page().texels().size());
        }
    }
    state.counters["bytes"] = static_cast<double>(most);
}
BENCHMARK(bytes_around_a_page)->ArgName("brief")->Arg(0)->Arg(1)->Iterations(10);

void memory_of_an_idle_stream(benchmark::State& state) {
    constexpr int streams = 1000;
    ServerOptions options = stream_options();
    options.streams.streams = streams + 1;
    LiveServer live{options};
    std::vector<RawClient> clients;
    clients.reserve(streams);
    proto::ClientMessage hello;
    hello.mutable_hello()->set_wants_edits(true);
    std::string bytes = hello.SerializeAsString();
    std::string frame{'\x82', static_cast<char>(0x80 | bytes.size())};
    frame += std::string(4, '\0') + bytes;
    for (auto _ : state) {
        const std::size_t before = mallinfo2().uordblks;
        for (int i = 0; i < streams; ++i) {
            clients.push_back(live.http());
            clients.back().send(
                "GET /scenes/made/stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n"
                "Connection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: tessera.stream.1\r\n\r\n");
            if (clients.back().receive()->status != 101) return state.SkipWithError("no stream");
            clients.back().send(frame);
        }
        std::this_thread::sleep_for(std::chrono::seconds{1});
        const auto after = static_cast<double>(mallinfo2().uordblks);
        state.counters["bytes_each"] = (after - static_cast<double>(before)) / streams;
    }
}
BENCHMARK(memory_of_an_idle_stream)->Iterations(1);

}  // namespace
}  // namespace tessera::test

BENCHMARK_MAIN();
