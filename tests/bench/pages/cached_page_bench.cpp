// What a page from the cache costs the server: CPU of all its threads, over loopback, at most 30 µs asked.
// And what making one costs beside its evaluation: encoding.
#include <ctime>

#include <benchmark/benchmark.h>

#include "server/pages/page_encoder.h"
#include "tests/end_to_end/server/running_server.h"

namespace tessera {
namespace {

using test::RawClient;
using test::RunningServer;

double cpu_seconds(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return double(time.tv_sec) + double(time.tv_nsec) * 1e-9;
}

/// CPU of this process but for the calling thread, which is the client.
double server_cpu_seconds() {
    return cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
}

void cached_page(benchmark::State& state, const std::string& target, const std::string& fields) {
    ServerOptions options = test::quick_options();
    options.io_threads = 1;
    RunningServer running{options};
    running.gated->open();
    const auto connections = static_cast<std::size_t>(state.range(0));
    std::vector<RawClient> clients;
    for (std::size_t i = 0; i < connections; ++i) clients.push_back(running.client());
    const auto first = clients.front().get(target, fields);
    if (!first || (first->status != 200 && first->status != 304)) return state.SkipWithError("wrong answer");
    const std::string request = "GET " + target + " HTTP/1.1\r\nHost: bench\r\n" + fields + "\r\n";

    const double before = server_cpu_seconds();
    for (auto _ : state) {
        for (RawClient& client : clients) client.send(request);
        for (RawClient& client : clients) {
            const auto reply = client.receive();
            if (!reply || reply->body.size() != first->body.size())
                return state.SkipWithError("wrong answer");
        }
    }
    const double pages = double(state.iterations()) * double(connections);
    state.counters["server_us_per_page"] = (server_cpu_seconds() - before) * 1e6 / pages;
    state.counters["page_bytes"] = double(first->body.size());
    state.SetItemsProcessed(static_cast<std::int64_t>(pages));
}

BENCHMARK_CAPTURE(cached_page, not_modified, test::gated_page, "If-None-Match: *\r\n")
    ->Arg(1)
    ->Arg(32)
    ->UseRealTime();
BENCHMARK_CAPTURE(cached_page, one_colour_png, "/scenes/grey/20/5/7.png", "")->Arg(1)->Arg(32)->UseRealTime();
BENCHMARK_CAPTURE(cached_page, checker_png, "/scenes/board/20/5/7.png", "")->Arg(1)->Arg(32)->UseRealTime();
BENCHMARK_CAPTURE(cached_page, noise_jpg, "/scenes/gated/20/5/7.jpg", "")->Arg(1)->Arg(32)->UseRealTime();
BENCHMARK_CAPTURE(cached_page, noise_png, "/scenes/gated/20/5/7.png", "")->Arg(1)->Arg(32)->UseRealTime();

void encode(benchmark::State& state, PageFormat format) {
    // A photograph-like page: smooth, with grain
    Rgba8Image image{page_side_texels, page_side_texels};
    std::uint32_t random = 1;
    for (std::size_t i = 0; i < image.bytes.size(); ++i) {
        random = random * 1664525 + 1013904223;
        const auto wave = static_cast<std::uint32_t>(i / 37 % 160);
        image.bytes[i] = i % 4 == 3 ? std::uint8_t{255} : static_cast<std::uint8_t>(wave + (random >> 28));
    }
    std::size_t bytes = 0;
    for (auto _ : state) bytes = encode_page(image, format).value().size();
    state.counters["page_bytes"] = double(bytes);
}
BENCHMARK_CAPTURE(encode, png, PageFormat::png)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(encode, jpg, PageFormat::jpg)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(encode, webp, PageFormat::webp)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tessera

BENCHMARK_MAIN();
