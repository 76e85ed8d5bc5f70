#include "server/http/load_site.h"

#include <exception>
#include <new>
#include <string_view>
#include <utility>

#include <spdlog/spdlog.h>

namespace tessera {
namespace {

namespace fs = std::filesystem;

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

Result<std::shared_ptr<const Access>> read_access(const ServerOptions& options) {
    if (options.tokens.empty()) return std::make_shared<const Access>();
    auto access = Access::load(options.tokens);
    if (!access) return Error{access.error().code, "--tokens " + access.error().detail};
    return std::make_shared<const Access>(std::move(*access));
}

/// Scenes that can be served. A folder of which nothing can be served is an error.
Result<std::shared_ptr<const Catalog>> read_scenes(const ServerOptions& options, const std::stop_token& stop,
                                                   const std::function<void(const LoadedScene&)>& tell) {
    // Messages name files by the folder's canonical path, and are found by it
    std::error_code failure;
    fs::path folder = fs::canonical(options.scenes, failure);
    if (failure)
        return Error{ErrorCode::io_failure, "--scenes " + options.scenes.string() + ": " + failure.message() +
                                                "; name a folder of prepared scenes"};
    auto catalog = load_catalog(folder, stop, tell);
    if (!catalog) return Error{catalog.error().code, "--scenes " + catalog.error().detail};
    for (Catalog::Problem& problem : catalog->broken) {
        problem.message = without_folder(std::move(problem.message), folder);
        // A scene may be a link to a folder elsewhere
        if (const fs::path linked = fs::canonical(folder / problem.id, failure); !failure)
            problem.message = without_folder(std::move(problem.message), linked, problem.id);
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

}  // namespace

std::string without_folder(std::string message, const fs::path& folder, const std::string& in_its_place) {
    const std::string inside = (folder / "").string();
    const std::string place = in_its_place.empty() ? "" : in_its_place + "/";
    // Only where a path begins: the folder / would be found in every path, and all over again
    constexpr std::string_view before_a_path = " \"'`(";
    for (std::size_t at = 0; (at = message.find(inside, at)) != std::string::npos;) {
        if (at == 0 || before_a_path.find(message[at - 1]) != std::string_view::npos) {
            message.replace(at, inside.size(), place);
            at += place.size();
        } else {
            ++at;
        }
    }
    // The folder itself, as in "/srv/wall: has no memory"
    if (const std::string itself = folder.string(); message.starts_with(itself + ":"))
        message.replace(0, itself.size(), in_its_place.empty() ? folder.filename().string() : in_its_place);
    return message;
}

Result<LoadedSite> load_site(const ServerOptions& options, const std::stop_token& stop,
                             const std::function<void(const LoadedScene&)>& tell) {
    // Input never throws on purpose, but memory may run out, and a server goes on with what it has
    try {
        auto access = read_access(options);
        if (!access) return access.error();
        auto web = read_web(options);
        if (!web) return web.error();
        auto catalog = read_scenes(options, stop, tell);
        if (!catalog) return catalog.error();
        return LoadedSite{std::move(*catalog), std::move(*web), std::move(*access)};
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::io_failure, "there is not enough memory to load the scenes and the web page"};
    } catch (const std::exception& unexpected) {
        return Error{ErrorCode::io_failure, std::string{"loading failed: "} + unexpected.what()};
    }
}

}  // namespace tessera
