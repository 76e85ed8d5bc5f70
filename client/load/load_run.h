#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "client/link/page_url.h"
#include "client/link/scene_info.h"
#include "client/link/server_address.h"
#include "client/load/load_tally.h"
#include "client/load/page_walk.h"

namespace tessera {

/// What to do to the server, and for how long. A run takes at most warmup + duration + drain, and a little.
struct LoadPlan {
    ServerAddress server;
    SceneInfo scene;
    FetchOptions options;
    std::size_t connections = 16;  ///< 1 to 20,000; one request at a time on each.
    /// Pages a second, planned at equal distances whatever the server does (open loop). Nothing: each
    /// connection asks for its next page when it has the last (closed loop).
    std::optional<double> rate{};
    std::chrono::nanoseconds warmup{0};  ///< Loads, but does not count.
    std::chrono::nanoseconds duration{std::chrono::seconds{10}};
    std::chrono::milliseconds timeout{10000};     ///< For one request, and for opening a connection.
    std::chrono::milliseconds drain{5000};        ///< After the last planned instant, for what is still out.
    bool accept_zstd = false;                     ///< Raw pages may come packed.
    bool verify = false;                          ///< Compare the bytes of pages that come again.
    bool stop_on_signals = false;                 ///< SIGINT and SIGTERM end the run early, cleanly.
    std::chrono::milliseconds progress_every{0};  ///< 0: no progress.
};

/// How a run stands. The references are good during the call only.
struct LoadProgress {
    std::chrono::nanoseconds elapsed{0};  ///< Warm-up included.
    std::chrono::nanoseconds total{0};
    bool warming_up = false;
    bool draining = false;
    std::chrono::nanoseconds since_last{0};
    std::uint64_t pages_since_last = 0;
    std::uint64_t bytes_since_last = 0;
    std::uint64_t errors_since_last = 0;
    const LatencyHistogram& recent;  ///< Of the pages since the last report.
    std::size_t in_flight = 0;
    std::uint64_t backlog = 0;  ///< Open loop: planned by now and not sent.
    const LoadTally& tally;
};

struct LoadOutcome {
    LoadTally tally;
    bool interrupted = false;
    double client_cores = 0;  ///< Processor time of this process over the run's time.
};

/// Runs the plan on the calling thread. Open loop: request k is planned for the instant start + k/rate, is
/// sent then or as soon as a connection is free, and its latency counts from the planned instant, so that a
/// stalled server cannot hide the requests that it kept from being sent ("coordinated omission").
LoadOutcome run_load(const LoadPlan& plan, PageWalk& walk,
                     const std::function<void(const LoadProgress&)>& report = {});

}  // namespace tessera
