#include "server/http/commands.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <stop_token>
#include <string_view>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "server/http/load_site.h"
#include "server/http/server.h"
#include "server/http/server_options.h"
#include "server/http/told_by_signals.h"
#include "server/progress/terminal_progress.h"

namespace tessera {
namespace {

/// What a person types, before it is checked.
struct ServeArguments {
    std::string listen = "127.0.0.1:7070";
    std::string web;
    std::size_t cache_mb = 256;
    std::size_t sample_mb = 512;
    double deadline_seconds = 10;
    double horizon_days = 30;
    bool keep_no_edits = false;
    ServerOptions options;
};

Result<void> read_listen(const std::string& text, ServerOptions& options) {
    const Error wrong{ErrorCode::invalid_input,
                      "--listen " + text + ": ADDRESS:PORT, such as 127.0.0.1:7070 or [::1]:0"};
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos || colon == 0) return wrong;
    const std::string port = text.substr(colon + 1);
    options.address = text.substr(0, colon);
    if (options.address.size() > 2 && options.address.front() == '[' && options.address.back() == ']')
        options.address = options.address.substr(1, options.address.size() - 2);
    if (port.empty() || port.size() > 5 ||
        !std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; }) ||
        std::stoul(port) > 65535)
        return wrong;
    options.port = static_cast<std::uint16_t>(std::stoul(port));
    return {};
}

/// The scenes with their edits.
std::shared_ptr<const Catalog> with_edits(Server& server, const Catalog& scenes) {
    auto catalog = std::make_shared<Catalog>(scenes);
    SilentProgress progress;
    server.edits().adopt(*catalog, progress);
    return catalog;
}

/// Whatever goes wrong, the server goes on with what it has.
void reload(Server& server, const ServerOptions& options, const std::stop_token& stop) {
    const auto failed = [&](std::string_view why) {
        server.metrics().reloads_failed.Increment();
        spdlog::error("the reload failed, the scenes stay as they were: {}", why);
    };
    try {
        spdlog::info("reloading the scenes");
        const auto site = load_site(options, stop);
        if (stop.stop_requested()) return;
        if (!site) return failed(site.error().detail);
        server.publish(with_edits(server, *site->catalog), site->web, site->access);
        spdlog::info("reloaded: {} scenes", site->catalog->scenes.size());
    } catch (const std::exception& unexpected) {
        failed(unexpected.what());
    }
}

/// Loads what is served first, and says how far it is: on a terminal by a line that is drawn again and again,
/// elsewhere by a line for each scene that takes long.
Result<LoadedSite> load_first_site(const ServerOptions& options, const std::stop_token& stop) {
    constexpr std::chrono::seconds long_time{3};
    if (isatty(STDERR_FILENO) == 0)
        return load_site(options, stop, [&](const LoadedScene& scene) {
            if (scene.time >= long_time)
                spdlog::info("loaded {} in {:.1f} s, {} of {} scenes", scene.id, scene.time.count(),
                             scene.loaded, scene.of);
        });
    std::optional<TerminalProgress> progress;
    progress.emplace("tessera serve", std::vector{TerminalProgress::Share{"loading the scenes", 1.0}}, false,
                     stop);
    progress->advance("loading the scenes", 0);
    return load_site(options, stop, [&](const LoadedScene& scene) {
        progress->advance("loading the scenes",
                          static_cast<double>(scene.loaded) / static_cast<double>(scene.of));
        if (scene.loaded == scene.of) progress.reset();  // before anything else is said
    });
}

Result<void> serve(ServeArguments& arguments) {
    ServerOptions& options = arguments.options;
    if (const auto read = read_listen(arguments.listen, options); !read) return read.error();
    options.web = arguments.web;
    options.pages.cache_bytes = arguments.cache_mb << 20;
    options.pages.deadline = std::chrono::milliseconds{static_cast<long>(arguments.deadline_seconds * 1000)};
    options.samples.threads = options.pages.threads;
    options.samples.memory_bytes = arguments.sample_mb << 20;
    options.samples.deadline = options.pages.deadline;
    options.edits.horizon.age =
        std::chrono::seconds{static_cast<std::int64_t>(arguments.horizon_days * 24 * 3600)};
    if (options.edits.folder.empty()) options.edits.folder = options.scenes / ".edits";
    if (arguments.keep_no_edits) options.edits.folder.clear();

    const sigset_t signals = block_signals();
    auto server = Server::start(options);
    if (!server) return server.error();
    const std::string address = (*server)->address();

    // Answers in flight end while the scene that is just being loaded does
    ReloadRequest reload_request;
    std::stop_source stop;
    const ToldBySignals told{signals, reload_request, stop, [&] {
                                 spdlog::info("stopping");
                                 (*server)->stop();
                             }};
    const auto site = load_first_site(options, stop.get_token());
    if (stop.stop_requested()) return {};
    if (!site) return site.error();
    (*server)->publish(with_edits(**server, *site->catalog), site->web, site->access);
    std::printf("tessera: listening on %s\n", address.c_str());
    std::fflush(stdout);

    while (reload_request.wait(stop.get_token())) reload(**server, options, stop.get_token());
    return {};
}

}  // namespace

void add_serve_command(CLI::App& app, int& exit_code) {
    auto* command = app.add_subcommand("serve", "Serves a folder of scenes over HTTP");
    const auto arguments = std::make_shared<ServeArguments>();
    ServerOptions& options = arguments->options;
    const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
    options.pages.threads = cores;
    options.io_threads = std::clamp<std::size_t>(cores / 2, 1, 4);

    command->add_option("--scenes", options.scenes, "A folder of scenes, or one scene")->required();
    command->add_option("--listen", arguments->listen, "ADDRESS:PORT; port 0 picks a free one")
        ->capture_default_str();
    command->add_option("--web", arguments->web,
                        "The built web page (default: share/tessera/web beside the program's bin folder)");
    command
        ->add_option("--threads", options.pages.threads,
                     "Threads that evaluate and encode pages, and as many more that sample")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    command->add_option("--io-threads", options.io_threads, "Threads that parse requests and send answers")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command->add_option("--cache-mb", arguments->cache_mb, "Memory for encoded pages, in MiB; 0 keeps none")
        ->check(CLI::Range(0, 1 << 20))
        ->capture_default_str();
    command
        ->add_option("--sample-mb", arguments->sample_mb,
                     "Memory for texels and tables of sampled scenes, in MiB")
        ->check(CLI::Range(16, 1 << 20))
        ->capture_default_str();
    command->add_option("--edits", options.edits.folder,
                        "Where the journals of edits are kept (default: .edits in the folder of scenes)");
    command->add_option("--tokens", options.tokens,
                        "Who may edit from elsewhere: a file that tessera token writes (default: nobody)");
    command->add_flag("--keep-no-edits", arguments->keep_no_edits, "Edits last as long as the server runs");
    command
        ->add_option(
            "--horizon-revisions", options.edits.horizon.revisions,
            "Edits that each journal remembers: beyond it, and behind a snapshot, they are forgotten, "
            "and late retries and tessera log are told so")
        ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000'000}))
        ->capture_default_str();
    command
        ->add_option("--horizon-days", arguments->horizon_days,
                     "Days that they are remembered, fractions too; likewise")
        ->check(CLI::Range(0.00001, 36500.0))
        ->capture_default_str();
    command
        ->add_option("--max-connections", options.max_connections,
                     "Open connections; one more is answered with 503")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    command
        ->add_option("--max-streams", options.streams.streams,
                     "Of these, open streams; one more is answered with 503")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    command
        ->add_option("--max-queue", options.pages.queued_pages,
                     "Pages that may wait for a thread; one more is answered with 503")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    command
        ->add_option(
            "--deadline", arguments->deadline_seconds,
            "Seconds from a request for a page, or for samples, to its texels; later is answered with 503")
        ->check(CLI::Range(0.01, 3600.0))
        ->capture_default_str();

    command->callback([arguments, &exit_code] {
        spdlog::set_default_logger(spdlog::stderr_color_mt("tessera"));
        const auto fail = [&exit_code](std::string_view why) {
            std::cerr << "tessera serve: " << why << '\n';
            exit_code = 1;
        };
        try {
            if (const auto served = serve(*arguments); !served) fail(served.error().detail);
        } catch (const std::exception& unexpected) {  // memory or threads for the start ran out
            fail(unexpected.what());
        }
    });
}

}  // namespace tessera
