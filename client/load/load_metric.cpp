#include <algorithm>
#include <charconv>
#include <functional>
#include <vector>

#include "client/load/load_tally.h"

namespace tessera {
namespace {

double milliseconds(std::chrono::nanoseconds duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

std::optional<double> share(std::uint64_t part, std::uint64_t whole) {
    if (whole == 0) return std::nullopt;
    return static_cast<double>(part) / static_cast<double>(whole);
}

using Reader = std::function<std::optional<double>(const LoadTally&)>;
struct Metric {
    std::string_view name;
    Reader read;
};

double number(std::uint64_t count) { return static_cast<double>(count); }

std::optional<double> hit_rate(const LoadTally& t) {
    std::uint64_t hits = 0, all = 0;
    for (const auto& [result, count] : t.cache_results) {
        all += count;
        if (result == "hit" || result.ends_with("; hit") || result.starts_with("HIT")) hits += count;
    }
    return share(hits, all);
}

std::optional<double> each_second(const LoadTally& t, std::uint64_t count) {
    if (t.measured.count() <= 0) return std::nullopt;
    const auto spent = std::max(t.measured, t.until_last_page);
    return number(count) / std::chrono::duration<double>(spent).count();
}

const std::vector<Metric>& counts() {
    static const std::vector<Metric> all{
        {"requests", [](const LoadTally& t) { return number(t.planned); }},
        {"pages", [](const LoadTally& t) { return number(t.ok); }},
        {"errors", [](const LoadTally& t) { return number(t.errors()); }},
        {"error_rate", [](const LoadTally& t) { return share(t.errors(), t.planned); }},
        {"shed", [](const LoadTally& t) { return number(t.shed); }},
        {"refused", [](const LoadTally& t) { return number(t.refused); }},
        {"timeouts", [](const LoadTally& t) { return number(t.timeouts); }},
        {"lost", [](const LoadTally& t) { return number(t.lost); }},
        {"unfinished", [](const LoadTally& t) { return number(t.unfinished); }},
        {"mismatches",
         [](const LoadTally& t) { return t.verified ? std::optional{number(t.mismatches)} : std::nullopt; }},
        {"changed",
         [](const LoadTally& t) { return t.verified ? std::optional{number(t.changed)} : std::nullopt; }},
        {"retagged",
         [](const LoadTally& t) { return t.verified ? std::optional{number(t.retagged)} : std::nullopt; }},
        {"pages_per_s", [](const LoadTally& t) { return each_second(t, t.ok); }},
        {"bytes_per_s", [](const LoadTally& t) { return each_second(t, t.body_bytes); }},
        {"hit_rate", hit_rate},
    };
    return all;
}

/// p50, p99.9, min, mean or max of a histogram.
std::optional<Reader> time_reader(std::string_view name) {
    using Choose = const LatencyHistogram& (*)(const LoadTally&);
    Choose choose = [](const LoadTally& t) -> const LatencyHistogram& { return t.latency(); };
    if (name.starts_with("uncorrected.")) {
        choose = [](const LoadTally& t) -> const LatencyHistogram& { return t.uncorrected; };
        name.remove_prefix(12);
    } else if (name.starts_with("late.")) {
        choose = [](const LoadTally& t) -> const LatencyHistogram& { return t.lateness; };
        name.remove_prefix(5);
    }
    std::function<std::chrono::nanoseconds(const LatencyHistogram&)> take;
    if (name == "min") {
        take = [](const LatencyHistogram& h) { return h.min(); };
    } else if (name == "mean") {
        take = [](const LatencyHistogram& h) { return h.mean(); };
    } else if (name == "max") {
        take = [](const LatencyHistogram& h) { return h.max(); };
    } else if (name.starts_with('p')) {
        double percent = 0;
        const auto [end, error] = std::from_chars(name.data() + 1, name.data() + name.size(), percent);
        if (error != std::errc{} || end != name.data() + name.size() || !(percent >= 0 && percent <= 100))
            return std::nullopt;
        take = [percent](const LatencyHistogram& h) { return h.percentile(percent); };
    } else {
        return std::nullopt;
    }
    return [choose, take](const LoadTally& t) -> std::optional<double> {
        const LatencyHistogram& histogram = choose(t);
        if (histogram.count() == 0) return std::nullopt;
        return milliseconds(take(histogram));
    };
}

std::optional<Reader> status_reader(std::string_view name) {
    if (!name.starts_with("status.")) return std::nullopt;
    unsigned status = 0;
    const auto [end, error] = std::from_chars(name.data() + 7, name.data() + name.size(), status);
    if (error != std::errc{} || end != name.data() + name.size() || status < 100 || status > 999)
        return std::nullopt;
    return [status](const LoadTally& t) -> std::optional<double> {
        const auto found = t.statuses.find(status);
        return found == t.statuses.end() ? 0 : number(found->second);
    };
}

std::optional<Reader> reader(std::string_view name) {
    for (const Metric& metric : counts())
        if (metric.name == name) return metric.read;
    if (auto status = status_reader(name)) return status;
    return time_reader(name);
}

}  // namespace

std::optional<double> load_metric(const LoadTally& tally, std::string_view name) {
    const auto read = reader(name);
    return read ? (*read)(tally) : std::nullopt;
}

bool is_load_metric(std::string_view name) { return reader(name).has_value(); }
bool is_time_metric(std::string_view name) { return time_reader(name).has_value(); }

std::string_view load_metric_help() {
    return "p50 p99 p99.9 … min mean max (times; of what a user waited), uncorrected.p99 …, late.p99 …, "
           "requests, pages, "
           "errors, error_rate, shed, refused, timeouts, lost, unfinished, status.404 …, pages_per_s, "
           "bytes_per_s, "
           "hit_rate; with --verify also mismatches, changed, retagged";
}

}  // namespace tessera
