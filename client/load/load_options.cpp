#include "client/load/load_options.h"

#include <cmath>
#include <iostream>

#include <CLI/CLI.hpp>

namespace tessera {
namespace {

constexpr const char* description =
    "Loads a Tessera server with the pages of a scene and says how long a viewer would have waited.";

constexpr const char* examples = R"(
Loops:
  With --rate the loop is open: pages are planned at that rate whatever the server does, and a page's latency counts
  from its planned instant, so a stalled server cannot hide the requests that it held up. Without --rate the loop is
  closed: each connection asks for its next page when it has the last; good for the greatest throughput, but its
  latencies leave out what was not asked for meanwhile.

Examples:
  tessera-load http://127.0.0.1:7070 pebbles
      as many random pages of all levels as 16 connections fetch in 10 s
  tessera-load http://127.0.0.1:7070 pebbles --rate 2000 --duration 60 --assert 'p99<=5ms' --assert 'errors==0'
      2000 pages a second for a minute; exit code 3 unless 99 % came within 5 ms, all without an error
  tessera-load http://127.0.0.1:7070 pebbles --walk camera --rate 500 --format rgba --gutter 4 --json result.json
      what a GL client asks for on a flight over the texture
  tessera-load http://127.0.0.1:7070 pebbles --levels 0-3=8,4-20=1 --working-set 5000 --verify
      mostly fine pages, out of 5000, each checked to be the same bytes whenever it comes again

Exit codes: 0 done; 1 nothing could be measured; 2 wrong command line; 3 an assertion failed; 130 interrupted.)";

/// Seconds, or a number with ms, s or min.
double seconds(const std::string& text) {
    std::size_t used = 0;
    const double value = std::stod(text, &used);
    const std::string unit = text.substr(used);
    const double factor = unit.empty() || unit == "s" ? 1 : unit == "ms" ? 1e-3 : unit == "min" ? 60 : NAN;
    return value * factor;
}

/// Accepts durations from `least` to `most` seconds.
CLI::Validator duration_between(double least, double most) {
    return CLI::Validator{[=](std::string& text) -> std::string {
                              try {
                                  const double value = seconds(text);
                                  if (value >= least && value <= most) return "";
                              } catch (const std::exception&) {
                              }
                              return "'" + text + "' is no time from " + CLI::detail::to_string(least) +
                                     " s to " + CLI::detail::to_string(most) + " s; write 30, 500ms or 2min";
                          },
                          "TIME"};
}

}  // namespace

CommandLine read_command_line(int argc, const char* const* argv) {
    CommandLine line;
    LoadOptions& options = line.options;
    LoadPlan& plan = options.plan;
    std::string url, format = "png", accuracy = "high", channels = "albedo", duration = "10", warmup = "1",
                     timeout = "10";
    std::vector<std::string> assertions;
    double rate = 0;

    CLI::App app{description, "tessera-load"};
    app.footer(examples);
    app.add_option("URL", url, "The server, as in http://127.0.0.1:7070")->required();
    app.add_option("SCENE", options.scene, "The scene's id")->required();

    app.add_option("--walk", options.walk,
                   "Which pages: random, sweep (neighbours, level by level) or camera (a flight)")
        ->check(CLI::IsMember({"random", "sweep", "camera"}))
        ->capture_default_str();
    app.add_option("--levels", options.levels,
                   "Levels, 0 the finest: 3, 0-8, or with weights 0-3=4,4-8=1; all if not given");
    app.add_option("--working-set", options.working_set,
                   "Random walk: stay within that many pages; 0 means the whole extent")
        ->check(CLI::Range(0, 10'000'000));
    app.add_option("--sweep-side", options.sweep_side,
                   "Sweep: pages along one side of the square swept on each level")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    app.add_option("--camera", options.camera_file,
                   "Camera path, as tessera-view replays it; a generated flight if not given");
    app.add_option("--seed", options.seed, "Another seed, other pages")->capture_default_str();

    app.add_option("--format", format, "png, jpg, webp or rgba")
        ->check(CLI::IsMember({"png", "jpg", "webp", "rgba"}))
        ->capture_default_str();
    app.add_option("--gutter", plan.options.gutter, "Texels around each page")
        ->check(CLI::Range(0, static_cast<int>(max_gutter_texels)))
        ->capture_default_str();
    app.add_option("--accuracy", accuracy, "exact, high or fast")
        ->check(CLI::IsMember({"exact", "high", "fast"}))
        ->capture_default_str();
    app.add_option("--channels", channels,
                   "albedo, normal, roughness, height or moments, if the scene has it")
        ->check(CLI::IsMember({"albedo", "normal", "roughness", "height", "moments"}))
        ->capture_default_str();
    app.add_flag("--zstd", plan.accept_zstd, "Accept raw pages packed by zstd");

    app.add_option("--connections", plan.connections, "Connections, one request at a time on each")
        ->check(CLI::Range(1, 20'000))
        ->capture_default_str();
    app.add_option("--rate", rate, "Pages a second (open loop); a closed loop if not given")
        ->check(CLI::Range(0.001, 1e6));
    app.add_option("--duration", duration, "Measured time: seconds, or 500ms, 2min")
        ->check(duration_between(0.01, 86'400))
        ->capture_default_str();
    app.add_option("--warmup", warmup, "Time before that, loaded and not counted")
        ->check(duration_between(0, 3'600))
        ->capture_default_str();
    app.add_option("--timeout", timeout, "For one request")
        ->check(duration_between(0.001, 600))
        ->capture_default_str();

    app.add_flag("--verify", plan.verify, "Check that a page that comes again has the same bytes and ETag");
    app.add_option("--assert", assertions,
                   "METRIC<=LIMIT, as in 'p99<=5ms' or 'errors==0'; a time without a unit is in "
                   "milliseconds; repeatable; exit code 3 if it fails. Metrics: " +
                       std::string{load_metric_help()})
        ->allow_extra_args(false);
    app.add_option("--json", options.json_file,
                   "Write the result as JSON; - for stdout, in place of the summary");
    app.add_flag("--quiet", options.quiet, "No progress and no summary");
    app.set_version_flag("--version", std::string{"tessera-load "} + TESSERA_VERSION);

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        line.exit_code = app.exit(error) == 0 ? 0 : 2;
        return line;
    }
    line.exit_code = 2;
    const auto fail = [&](const std::string& why) {
        std::cerr << "tessera-load: " << why << "\n";
        return line;
    };

    if (!std::isfinite(rate)) return fail("--rate must be a number");
    auto server = parse_server_address(url);
    if (!server) return fail(server.error().detail);
    options.server = plan.server = std::move(*server);
    for (const std::string& text : assertions) {
        auto assertion = parse_assertion(text);
        if (!assertion) return fail(assertion.error().detail);
        if (assertion->metric == "mismatches" || assertion->metric == "changed" ||
            assertion->metric == "retagged")
            plan.verify = true;  // there is no value otherwise
        options.assertions.push_back(std::move(*assertion));
    }
    if (!options.camera_file.empty() && options.walk != "camera") return fail("--camera needs --walk camera");
    if (plan.accept_zstd && format != "rgba") return fail("--zstd needs --format rgba");
    plan.options.format = *page_format(format);
    plan.options.accuracy = *accuracy_named(accuracy);
    plan.options.channels = *channel_set_named(channels);
    if (rate > 0) plan.rate = rate;
    const auto nanoseconds_of = [](const std::string& text) {
        return std::chrono::nanoseconds{std::llround(seconds(text) * 1e9)};
    };
    plan.duration = nanoseconds_of(duration);
    plan.warmup = nanoseconds_of(warmup);
    plan.timeout = std::chrono::ceil<std::chrono::milliseconds>(nanoseconds_of(timeout));
    plan.drain = std::min(plan.timeout, std::chrono::milliseconds{5000});
    plan.stop_on_signals = true;
    line.go_on = true;
    line.exit_code = 0;
    return line;
}

}  // namespace tessera
