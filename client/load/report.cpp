#include "client/load/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "client/load/json_writer.h"
#include "client/load/report_text.h"

namespace tessera {
namespace {

using std::chrono::nanoseconds;
constexpr std::array<double, 8> percents{50, 75, 90, 95, 99, 99.9, 99.99, 99.999};

double milliseconds(nanoseconds duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

std::string percent_name(double percent) {
    std::array<char, 24> text{};
    std::snprintf(text.data(), text.size(), "p%g", percent);
    return text.data();
}

void write_latencies(JsonWriter& json, std::string_view name, const LatencyHistogram& histogram) {
    if (histogram.count() == 0) {
        json.null(name);
        return;
    }
    json.begin_object(name).field("count", histogram.count()).field("min", milliseconds(histogram.min()));
    for (const double percent : percents)
        json.field(percent_name(percent), milliseconds(histogram.percentile(percent)));
    json.field("max", milliseconds(histogram.max()))
        .field("mean", milliseconds(histogram.mean()))
        .end_object();
}

void write_buckets(JsonWriter& json, std::string_view name, const LatencyHistogram& histogram) {
    json.begin_array(name);
    for (const auto& bucket : histogram.filled())
        json.element("[" + std::to_string(bucket.lowest) + ", " + std::to_string(bucket.highest) + ", " +
                     std::to_string(bucket.count) + "]");
    json.end_array();
}

std::string fixed(double value, int decimals) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
    return text.data();
}

std::string padded(std::string text, std::size_t width) {
    // µ takes two bytes and one column
    const auto columns = static_cast<std::size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
    if (columns < width) text.insert(0, width - columns, ' ');
    return text;
}

}  // namespace

std::vector<std::string> warnings_of(const LoadOutcome& outcome) {
    std::vector<std::string> warnings;
    const LoadTally& tally = outcome.tally;
    if (outcome.interrupted) warnings.emplace_back("interrupted: these are the figures up to then");
    const nanoseconds late = tally.lateness.percentile(99), median = tally.latency().percentile(50);
    if (late > std::max<nanoseconds>(std::chrono::milliseconds{1}, median / 10))
        warnings.push_back(
            "the load generator itself was late: 1 % of the requests were sent " + duration_text(late) +
            " or more after their instant although a connection was free; use a quieter machine");
    if (outcome.client_cores > 0.9)
        warnings.push_back("the load generator used " + fixed(outcome.client_cores, 2) +
                           " of its one core: the server may be faster than these figures");
    if (tally.open_loop && tally.unfinished > 0)
        warnings.push_back(
            count_text(tally.unfinished) +
            " planned pages had no answer at the end; they count with the time they had waited until then");
    if (!tally.open_loop && tally.sent > 0)
        warnings.emplace_back(
            "closed loop: latencies leave out what was not asked for while the server stalled; for what "
            "viewers wait give --rate");
    if (tally.forgetful)
        warnings.emplace_back("more pages than --verify remembers: later ones were not compared");
    return warnings;
}

std::string json_report(const LoadOptions& options, const LoadOutcome& outcome,
                        const std::vector<AssertionOutcome>& assertions) {
    const LoadTally& tally = outcome.tally;
    const LoadPlan& plan = options.plan;
    const auto seconds = [](nanoseconds duration) { return std::chrono::duration<double>(duration).count(); };
    JsonWriter json;
    json.begin_object()
        .field("tessera_load", 1)
        .field("server", plan.server.url())
        .field("scene", plan.scene.id)
        .field("scene_fingerprint", plan.scene.fingerprint)
        .field("scene_revision", plan.scene.revision);
    json.begin_object("options")
        .field("loop", tally.open_loop ? "open" : "closed")
        .field("rate", plan.rate)
        .field("connections", plan.connections)
        .field("walk", options.walk)
        .field("levels", options.levels)
        .field("working_set", options.working_set)
        .field("seed", options.seed)
        .field("format", extension(plan.options.format))
        .field("gutter", plan.options.gutter)
        .field("accuracy", name_of(plan.options.accuracy))
        .field("channels", name_of(plan.options.channels))
        .field("zstd", plan.accept_zstd)
        .field("warmup_s", seconds(plan.warmup))
        .field("duration_s", seconds(plan.duration))
        .field("timeout_s", seconds(plan.timeout))
        .end_object();
    json.field("measured_s", tally.seconds())
        .field("interrupted", outcome.interrupted)
        .field("client_cores", outcome.client_cores);
    json.begin_object("requests")
        .field("planned", tally.planned)
        .field("sent", tally.sent)
        .field("pages", tally.ok)
        .field("errors", tally.errors())
        .field("shed", tally.shed)
        .field("refused", tally.refused)
        .field("timeouts", tally.timeouts)
        .field("lost", tally.lost)
        .field("unfinished", tally.unfinished)
        .end_object();
    json.field("pages_per_s", load_metric(tally, "pages_per_s"))
        .field("bytes_per_s", load_metric(tally, "bytes_per_s"))
        .field("body_bytes", tally.body_bytes);
    json.begin_object("latency_ms");
    write_latencies(json, "corrected", tally.corrected);
    write_latencies(json, "uncorrected", tally.uncorrected);
    json.end_object();
    write_latencies(json, "lateness_ms", tally.lateness);

    json.begin_object("statuses");
    for (const auto& [status, count] : tally.statuses) json.field(std::to_string(status), count);
    json.end_object().begin_object("levels");
    for (std::size_t level = 0; level < tally.pages_of_level.size(); ++level)
        if (tally.pages_of_level[level] > 0) json.field(std::to_string(level), tally.pages_of_level[level]);
    json.end_object().begin_object("cache_results");
    for (const auto& [result, count] : tally.cache_results) json.field(result, count);
    json.end_object().field("hit_rate", load_metric(tally, "hit_rate"));
    if (tally.verified) {
        json.begin_object("verify")
            .field("compared", tally.compared)
            .field("mismatches", tally.mismatches)
            .field("changed", tally.changed)
            .field("retagged", tally.retagged)
            .end_object();
    } else {
        json.null("verify");
    }
    json.begin_array("warnings");
    for (const std::string& warning : warnings_of(outcome)) json.element(JsonWriter::quoted(warning));
    json.end_array().field("first_problem", tally.first_problem);
    json.begin_array("assertions");
    for (const AssertionOutcome& assertion : assertions)
        json.begin_object()
            .field("assertion", assertion.assertion.text)
            .field("actual", assertion.actual)
            .field("holds", assertion.holds)
            .end_object();
    json.end_array();
    json.begin_object("histograms_ns");
    write_buckets(json, "corrected", tally.corrected);
    write_buckets(json, "uncorrected", tally.uncorrected);
    return json.end_object().end_object().text();
}

std::string text_report(const LoadOptions& options, const LoadOutcome& outcome,
                        const std::vector<AssertionOutcome>& assertions) {
    const LoadTally& tally = outcome.tally;
    const LoadPlan& plan = options.plan;
    std::ostringstream out;
    out << plan.server.url() << "  scene " << plan.scene.id << ", " << options.walk << " walk, "
        << extension(plan.options.format)
        << (plan.options.gutter > 0 ? ", gutter " + std::to_string(plan.options.gutter) : "") << ", "
        << plan.connections << " connections, "
        << (plan.rate ? "open loop at " + fixed(*plan.rate, *plan.rate < 10 ? 2 : 0) + " pages/s"
                      : "closed loop")
        << ", " << fixed(tally.seconds(), 1) << " s measured\n\n";
    out << "  pages   " << count_text(tally.ok) << " of " << count_text(tally.planned)
        << (tally.open_loop ? " planned" : " asked for") << ", "
        << fixed(load_metric(tally, "pages_per_s").value_or(0), 1) << "/s, "
        << bytes_text(load_metric(tally, "bytes_per_s").value_or(0)) << "/s";
    if (tally.ok > 0)
        out << ", " << bytes_text(static_cast<double>(tally.body_bytes) / static_cast<double>(tally.ok))
            << " each";
    out << "\n  errors  " << count_text(tally.errors());
    if (tally.errors() > 0)
        out << ": " << tally.shed << " shed (503, 429), " << tally.refused << " other statuses, "
            << tally.timeouts << " timeouts, " << tally.lost << " lost, " << tally.unfinished
            << " unfinished";
    out << "\n  status ";
    for (const auto& [status, count] : tally.statuses)
        out << " " << status << ": " << count_text(count) << " ";
    out << "\n  levels ";
    for (std::size_t level = 0; level < tally.pages_of_level.size(); ++level)
        if (tally.pages_of_level[level] > 0)
            out << " " << level << ": " << count_text(tally.pages_of_level[level]) << " ";
    out << "\n";
    if (!tally.cache_results.empty()) {
        out << "  cache  ";
        for (const auto& [result, count] : tally.cache_results)
            out << " " << result << ": " << count_text(count) << " ";
        out << "\n";
    }
    if (tally.verified)
        out << "  verify  " << count_text(tally.compared) << " compared, " << tally.mismatches
            << " mismatches, " << tally.changed << " changed, " << tally.retagged << " retagged\n";

    // Side by side, since their difference is what a closed loop hides
    out << "\n  latency   "
        << (tally.open_loop ? "from the planned instant   from sending\n" : "from sending\n");
    const auto row = [&](const std::string& name, auto value) {
        out << "  " << name << std::string(name.size() < 8 ? 8 - name.size() : 0, ' ');
        if (tally.open_loop) out << padded(duration_text(value(tally.corrected)), 24);
        out << padded(duration_text(value(tally.uncorrected)), tally.open_loop ? 15 : 12) << "\n";
    };
    row("mean", [](const LatencyHistogram& h) { return h.mean(); });
    for (const double percent : percents)
        row(percent_name(percent), [&](const LatencyHistogram& h) { return h.percentile(percent); });
    row("max", [](const LatencyHistogram& h) { return h.max(); });

    if (!tally.first_problem.empty()) out << "\n  first problem: " << tally.first_problem << "\n";
    for (const std::string& warning : warnings_of(outcome)) out << "\n  note: " << warning << "\n";
    if (!assertions.empty()) out << "\n";
    for (const AssertionOutcome& assertion : assertions) out << "  " << assertion_text(assertion) << "\n";
    return out.str();
}

std::string assertion_text(const AssertionOutcome& outcome) {
    const bool is_time = is_time_metric(outcome.assertion.metric);
    std::string text = (outcome.holds ? "holds   " : "FAILED  ") + outcome.assertion.text + "  (";
    if (!outcome.actual) return text + "nothing measured)";
    const bool whole = !is_time && *outcome.actual == std::floor(*outcome.actual);
    return text + fixed(*outcome.actual, whole ? 0 : is_time ? 3 : 4) + (is_time ? " ms)" : ")");
}

}  // namespace tessera
