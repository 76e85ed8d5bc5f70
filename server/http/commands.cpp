#include "server/http/commands.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <pthread.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "server/http/server.h"
#include "server/http/server_options.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

/// What a person types, before it is checked.
struct ServeArguments {
    std::string listen = "127.0.0.1:7070";
    std::string web;
    std::size_t cache_mb = 256;
    double deadline_seconds = 10;
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

/// share/tessera/web beside the bin folder that this program runs from.
fs::path installed_web() {
    std::error_code failure;
    const fs::path program = fs::read_symlink("/proc/self/exe", failure);
    return program.parent_path().parent_path() / "share" / "tessera" / "web";
}

Result<std::shared_ptr<const WebFiles>> read_web(const ServerOptions& options) {
    if (!options.web.empty()) return WebFiles::read(options.web);
    std::error_code failure;
    const fs::path folder = installed_web();
    return fs::is_directory(folder, failure) ? WebFiles::read(folder) : WebFiles::plain();
}

/// Scenes that can be served. A folder of which nothing can be served is an error.
Result<std::shared_ptr<const Catalog>> read_scenes(const ServerOptions& options) {
    auto catalog = load_catalog(options.scenes);
    if (!catalog) return Error{catalog.error().code, "--scenes " + catalog.error().detail};
    // /scenes shows these messages to everybody, so they name files inside the folder only
    const std::string folder = (options.scenes / "").string();
    for (Catalog::Problem& problem : catalog->broken) {
        for (std::size_t at; (at = problem.message.find(folder)) != std::string::npos;)
            problem.message.erase(at, folder.size());
        spdlog::error("scene {} is left out: {}", problem.id, problem.message);
    }
    if (catalog->scenes.empty())
        return Error{ErrorCode::invalid_input,
                     "--scenes " + options.scenes.string() + ": holds no scene that can be served" +
                         (catalog->broken.empty() ? "; a scene is a folder with a scene.json" : "")};
    for (const auto& [id, scene] : catalog->scenes)
        spdlog::info("scene {}: {}, {} texels a side, fingerprint {}", id, scene->texture->kind(),
                     scene->extent.side_texels(), scene->fingerprint);
    return std::make_shared<const Catalog>(std::move(*catalog));
}

void reload(Server& server, const ServerOptions& options) {
    spdlog::info("reloading the scenes");
    const auto catalog = read_scenes(options);
    const auto web = catalog ? read_web(options) : Error{};
    if (catalog && web) {
        server.publish(*catalog, *web);
        spdlog::info("reloaded: {} scenes", (*catalog)->scenes.size());
        return;
    }
    server.metrics().reloads_failed.Increment();
    spdlog::error("the reload failed, the scenes stay as they were: {}",
                  catalog ? web.error().detail : catalog.error().detail);
}

/// Serves until a signal asks to stop, and stops. Reloads run beside, one at a time, so that a stop does not
/// wait in line behind one.
void serve_until_told(Server& server, const ServerOptions& options, const sigset_t& signals) {
    std::thread reloading;
    for (int signal = 0; sigwait(&signals, &signal) == 0 && signal == SIGHUP;) {
        if (reloading.joinable()) reloading.join();
        reloading = std::thread{[&] { reload(server, options); }};
    }
    spdlog::info("stopping");
    server.stop();
    if (reloading.joinable()) reloading.join();
}

Result<void> serve(ServeArguments& arguments) {
    ServerOptions& options = arguments.options;
    if (const auto read = read_listen(arguments.listen, options); !read) return read.error();
    options.web = arguments.web;
    options.pages.cache_bytes = arguments.cache_mb << 20;
    options.pages.deadline = std::chrono::milliseconds{static_cast<long>(arguments.deadline_seconds * 1000)};

    // Signals are taken by sigwait() alone, so every thread is born with them blocked
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::signal(SIGPIPE, SIG_IGN);

    auto server = Server::start(options);
    if (!server) return server.error();
    const auto web = read_web(options);
    if (!web) return web.error();
    const auto catalog = read_scenes(options);
    if (!catalog) return catalog.error();
    (*server)->publish(*catalog, *web);
    std::printf("tessera: listening on %s\n", (*server)->address().c_str());
    std::fflush(stdout);

    serve_until_told(**server, options, signals);
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
    command->add_option("--threads", options.pages.threads, "Threads that evaluate and encode pages")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    command->add_option("--io-threads", options.io_threads, "Threads that parse requests and send answers")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    command->add_option("--cache-mb", arguments->cache_mb, "Memory for encoded pages, in MiB; 0 keeps none")
        ->check(CLI::Range(0, 1 << 20))
        ->capture_default_str();
    command
        ->add_option("--max-connections", options.max_connections,
                     "Open connections; one more is answered with 503")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    command
        ->add_option("--max-queue", options.pages.queued_pages,
                     "Pages that may wait for a thread; one more is answered with 503")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    command
        ->add_option("--deadline", arguments->deadline_seconds,
                     "Seconds from a request for a page to its texels; later is answered with 503")
        ->check(CLI::Range(0.01, 3600.0))
        ->capture_default_str();

    command->callback([arguments, &exit_code] {
        spdlog::set_default_logger(spdlog::stderr_color_mt("tessera"));
        if (const auto served = serve(*arguments); !served) {
            std::cerr << "tessera serve: " << served.error().detail << '\n';
            exit_code = 1;
        }
    });
}

}  // namespace tessera
