#include "server/scene/scene.h"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <mutex>
#include <optional>
#include <sstream>
#include <system_error>
#include <thread>
#include <vector>

#include "proto/scene.pb.h"

#include "server/scene/compile_scene.h"
#include "server/scene/fingerprint.h"
#include "server/scene/opening_view.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

/// Maps of patterns may be written into it. Larger ones belong into images.
constexpr std::uintmax_t max_scene_file_bytes = 8 << 20;

Error invalid(const fs::path& file, const std::string& what) {
    return {ErrorCode::invalid_input, file.string() + ": " + what};
}

Result<std::string> read_text(const fs::path& file) {
    std::error_code failure;
    const auto bytes = fs::file_size(file, failure);
    if (failure) return Error{ErrorCode::io_failure, file.string() + ": " + failure.message()};
    if (bytes > max_scene_file_bytes)
        return invalid(file, "is larger than 8 MiB; keep large maps as images beside it");
    std::ifstream in{file, std::ios::binary};
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) return Error{ErrorCode::io_failure, file.string() + ": cannot be read"};
    return text.str();
}

/// Why a folder without a scene.json is no scene.
Error no_scene(const fs::path& folder) {
    std::error_code failure;
    for (fs::directory_iterator entry{folder, failure}, end; !failure && entry != end;
         entry.increment(failure))
        if (std::error_code hidden; fs::exists(entry->path() / "scene.json", hidden))
            return invalid(folder,
                           "is a folder of scenes; name one of them, such as " + entry->path().string());
    return invalid(folder, "holds no scene.json, so it is no scene");
}

Result<ScenePtr> load_once(const fs::path& folder, const std::string& id) {
    const fs::path file = folder / "scene.json";
    std::error_code failure;
    if (fs::is_directory(folder, failure) && !fs::exists(file, failure)) return no_scene(folder);
    const auto text = read_text(file);
    if (!text) return text.error();
    proto::Scene message;
    if (auto read = read_json(*text, file.string(), message); !read) return read.error();

    auto scene = std::make_shared<Scene>();
    scene->id = id;
    if (!is_scene_id(scene->id))
        return invalid(folder, "a scene's folder is named with 1 to 64 of letters, digits, '-', '_' and '.'");
    scene->title = message.title().empty() ? scene->id : message.title();
    scene->attribution = message.attribution();
    const std::uint32_t n = message.extent_log2_pages() == 0 ? 20 : message.extent_log2_pages();
    if (n > max_level)
        return invalid(file,
                       "extent_log2_pages: is " + std::to_string(n) + "; from 1 to 30 (2^38 texels a side)");
    scene->extent.n = static_cast<std::uint8_t>(n);
    if (message.has_view()) {
        const auto view = opening_view_of(message.view(), scene->extent);
        if (!view) return invalid(file, view.error().detail);
        scene->view = *view;
    }

    // The fingerprint must name the bytes that were compiled: where an asset changes meanwhile, all is read
    // again
    const auto before = fingerprint_of(folder, *text);
    if (!before) return before.error();
    if (auto compiled = compile_scene(folder, file, message, *scene); !compiled) return compiled.error();
    auto after = fingerprint_of(folder, *text);
    if (!after) return after.error();
    if (*before != *after) return Error{ErrorCode::page_changed, {}};
    scene->fingerprint = *after;
    return ScenePtr{std::move(scene)};
}

Result<ScenePtr> load_named(const fs::path& folder, const std::string& id) {
    // Input never throws on purpose, but memory may run out, and a folder may be odder than we think
    try {
        for (int attempt = 0; attempt < 3; ++attempt)
            if (auto scene = load_once(folder, id); scene || scene.error().code != ErrorCode::page_changed)
                return scene;
        return Error{ErrorCode::io_failure,
                     folder.string() + ": kept changing while it was read; load it again"};
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::io_failure, folder.string() + ": there is not enough memory for it"};
    } catch (const std::exception& unexpected) {
        return Error{ErrorCode::io_failure, folder.string() + ": " + unexpected.what()};
    }
}

struct NamedFolder {
    fs::path path;
    std::string name;
};

/// As many scenes at a time as there are processors, up to 4. Those behind `stop` are empty.
std::vector<std::optional<Result<ScenePtr>>> load_all(const std::vector<NamedFolder>& folders,
                                                      const std::stop_token& stop,
                                                      const std::function<void(const LoadedScene&)>& tell) {
    constexpr unsigned most_at_once = 4;
    std::vector<std::optional<Result<ScenePtr>>> loaded(folders.size());
    std::atomic<std::size_t> next{0};
    std::mutex telling;
    std::size_t done = 0;
    const auto run = [&] {
        for (std::size_t i = next++; i < folders.size() && !stop.stop_requested(); i = next++) {
            const auto begin = std::chrono::steady_clock::now();
            loaded[i] = load_named(folders[i].path, folders[i].name);
            if (!tell) continue;
            const std::lock_guard lock{telling};
            tell({folders[i].name, std::chrono::steady_clock::now() - begin, ++done, folders.size()});
        }
    };
    std::vector<std::jthread> helpers;
    try {
        for (unsigned i = 1; i < std::min(most_at_once, std::thread::hardware_concurrency()); ++i)
            if (i < folders.size()) helpers.emplace_back(run);
    } catch (const std::system_error&) {
        // No more threads: those that there are do it
    }
    run();
    helpers.clear();
    return loaded;
}

}  // namespace

bool is_scene_id(std::string_view id) {
    const auto allowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
               c == '_' || c == '.';
    };
    return !id.empty() && id.size() <= 64 && id.front() != '.' && std::all_of(id.begin(), id.end(), allowed);
}

Result<ScenePtr> load_scene(const fs::path& folder) {
    std::error_code failure;
    const fs::path canonical = fs::weakly_canonical(folder, failure);
    return load_named(folder, (failure ? folder : canonical).filename().string());
}

ScenePtr Catalog::find(std::string_view id) const {
    if (const auto now = edited.find(id); now != edited.end()) return now->second->now();
    const auto found = scenes.find(id);
    return found == scenes.end() ? nullptr : found->second;
}

const Catalog::Problem* Catalog::problem_of(std::string_view id) const {
    const auto found =
        std::find_if(broken.begin(), broken.end(), [&](const Problem& problem) { return problem.id == id; });
    return found == broken.end() ? nullptr : &*found;
}

Result<Catalog> load_catalog(const fs::path& folder, std::stop_token stop,
                             const std::function<void(const LoadedScene&)>& tell) {
    std::error_code failure;
    std::vector<fs::path> folders;
    if (fs::exists(folder / "scene.json", failure)) {
        folders.push_back(folder);
    } else {
        for (fs::directory_iterator entry{folder, failure}, end; !failure && entry != end;
             entry.increment(failure)) {
            std::error_code hidden;  // a folder that may not be looked into is not a scene of ours
            if (fs::exists(entry->path() / "scene.json", hidden) || (hidden && entry->is_directory(failure)))
                folders.push_back(entry->path());
        }
        if (failure)
            return Error{ErrorCode::io_failure, folder.string() + ": " + failure.message() +
                                                    "; name a folder of prepared scenes with --scenes"};
    }
    std::sort(folders.begin(), folders.end());

    std::vector<NamedFolder> named;
    for (const fs::path& path : folders) {
        // The entry's own name, not what a link leads to: two links to folders of one name are two scenes
        fs::path name = path.filename();
        if (name.empty() || name == "." || name == "..")
            name = fs::weakly_canonical(path, failure).filename();
        if (name.string().starts_with('.')) continue;  // what a preparation has not finished
        named.push_back({path, name.string()});
    }
    const auto loaded = load_all(named, stop, tell);
    if (stop.stop_requested()) return Error{ErrorCode::cancelled, "loading was stopped"};

    Catalog catalog;
    for (std::size_t i = 0; i < named.size(); ++i) {
        if (*loaded[i])
            catalog.scenes.emplace((**loaded[i])->id, **loaded[i]);
        else
            catalog.broken.push_back({named[i].name, loaded[i]->error().detail});
    }
    return catalog;
}

}  // namespace tessera
