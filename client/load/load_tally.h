#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "client/load/histogram.h"
#include "shared/page/page_key.h"

namespace tessera {

/// What a load run has measured. Counts are of requests whose planned (open loop) or sent (closed loop)
/// instant lies in the measured time; what was asked during the warm-up is in none of them.
struct LoadTally {
    bool open_loop = false;
    std::chrono::nanoseconds measured{0};  ///< The time over which requests were planned or sent.

    /// From the measured time's begin to the last page, if that came after its end: rates are over the
    /// longer.
    std::chrono::nanoseconds until_last_page{0};

    std::uint64_t planned = 0;  ///< Open loop: by the schedule. Closed loop: the same as sent.
    std::uint64_t sent = 0;
    std::uint64_t ok = 0;       ///< Answered 200 with a page.
    std::uint64_t shed = 0;     ///< Answered 503 or 429.
    std::uint64_t refused = 0;  ///< Any other status.
    std::uint64_t timeouts = 0;
    std::uint64_t lost = 0;        ///< No connection, connection lost, or no HTTP.
    std::uint64_t unfinished = 0;  ///< Planned, but not answered (or not even sent) when the run ended.
    std::uint64_t body_bytes = 0;  ///< Of 200s.

    /// From the planned instant: pages, and as lower bounds timeouts and unfinished ones. Open loop only.
    LatencyHistogram corrected;
    /// From the instant of sending: pages, and as lower bounds timeouts.
    LatencyHistogram uncorrected;
    /// How late a request was sent although a connection was free: our own doing, not the server's.
    LatencyHistogram lateness;

    std::map<unsigned, std::uint64_t> statuses;
    std::map<std::string, std::uint64_t> cache_results;  ///< As the server's headers tell; at most 16 kinds.
    std::array<std::uint64_t, max_level + 1> pages_of_level{};
    std::string first_problem;  ///< What went wrong first, in full; empty if nothing.

    // Filled by --verify: pages seen before, and how their bytes and tags compare with then
    bool verified = false;
    std::uint64_t compared = 0;
    std::uint64_t mismatches = 0;  ///< Other bytes under the same ETag, or without one.
    std::uint64_t changed =
        0;  ///< Other bytes under another ETag: an edit, or a server that is not deterministic.
    std::uint64_t retagged = 0;  ///< The same bytes under another ETag.
    bool forgetful = false;      ///< More pages than could be remembered.

    /// All that did not end with a page.
    std::uint64_t errors() const { return shed + refused + timeouts + lost + unfinished; }
    /// The histogram that answers for "latency": the corrected one where there is a plan.
    const LatencyHistogram& latency() const { return open_loop ? corrected : uncorrected; }
    double seconds() const { return std::chrono::duration<double>(measured).count(); }
};

/// A measure by the name that --assert uses (load_metric_help() lists them); times in milliseconds, shares 0
/// to 1. Nothing where there is no such measure, or no value for it.
std::optional<double> load_metric(const LoadTally& tally, std::string_view name);
/// Whether there is such a measure at all, with a value or not.
bool is_load_metric(std::string_view name);
/// Whether its values are milliseconds.
bool is_time_metric(std::string_view name);
/// The names, for people.
std::string_view load_metric_help();

}  // namespace tessera
