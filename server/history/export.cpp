#include "server/history/export.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>
#include <vector>

#include <fcntl.h>

#include "proto/scene.pb.h"

#include "server/edits/live_scene.h"
#include "server/files/whole_file.h"
#include "server/history/past_journal.h"
#include "shared/wire/json.h"

namespace tessera {

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t max_scene_file_bytes = std::int64_t{1} << 30;
constexpr double default_rate = 10;  ///< Of a scene file that says none: Clock.steps_per_second

Error failed(const fs::path& file, const std::error_code& why) {
    return {ErrorCode::io_failure, file.string() + ": " + why.message()};
}

Result<void> write_text(const fs::path& file, const std::string& text) {
    return write_whole_file(file, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// The scene file with what edits changed.
Result<void> write_scene_file(const fs::path& from, proto::LiveState state, const fs::path& to) {
    const auto text = read_whole_file(from, max_scene_file_bytes);
    if (!text) return text.error();
    proto::Scene file;
    if (auto read = read_json(*text, from.string(), file); !read) return read;
    proto::Scene scene = state.has_scene() ? std::move(*state.mutable_scene()) : file;
    if (file.has_sprites()) *scene.mutable_sprites() = file.sprites();
    auto& sprites = *state.mutable_sprites();
    std::sort(sprites.begin(), sprites.end(), [](const auto& a, const auto& b) { return a.id() < b.id(); });
    if (!sprites.empty() || file.has_sprites()) *scene.mutable_sprites()->mutable_placed() = sprites;
    const double rate = state.clock().steps_per_second();
    const double rate_of_file =
        file.clock().steps_per_second() == 0 ? default_rate : file.clock().steps_per_second();
    if (rate != rate_of_file) scene.mutable_clock()->set_steps_per_second(rate);
    return write_text(to, write_brief_json(scene));
}

/// All files but the scene file; hidden ones, such as journals, are none of the scene's.
Result<void> copy_assets(const fs::path& from, const fs::path& to, Progress& progress) {
    std::error_code failure;
    std::vector<fs::path> files;
    std::uintmax_t bytes = 0, copied = 0;
    fs::recursive_directory_iterator entry{from, failure}, end;
    for (; !failure && entry != end; entry.increment(failure)) {
        if (entry->path().filename().string().starts_with('.')) {
            entry.disable_recursion_pending();
        } else if (std::error_code odd; entry->is_regular_file(odd)) {
            files.push_back(entry->path());
            bytes += entry->file_size(odd);
        }
    }
    if (failure) return failed(from, failure);
    for (const fs::path& file : files) {
        if (progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
        progress.advance("copying assets", static_cast<double>(copied) / static_cast<double>(bytes + 1));
        const fs::path name = file.lexically_relative(from);
        if (name == "scene.json") continue;
        fs::create_directories((to / name).parent_path(), failure);
        if (!failure) fs::copy_file(file, to / name, failure);
        if (failure) return failed(to / name, failure);
        copied += fs::file_size(to / name, failure);
    }
    return {};
}

Result<proto::LiveState> state_at(const ScenePtr& scene, Journal& journal, Revision revision,
                                  Progress& progress) {
    auto past = PastJournal::at(journal, revision);
    if (!past) return past.error();
    const auto live = LiveScene::open(scene, std::move(*past), progress);
    if (!live) return live.error();
    return (*live)->state();
}

}  // namespace

Result<void> export_scene(const fs::path& folder, Journal& journal, Revision revision, const fs::path& output,
                          Progress& progress) {
    std::error_code failure;
    fs::path whole = fs::absolute(output, failure).lexically_normal();
    if (!whole.has_filename()) whole = whole.parent_path();
    if (failure) return failed(output, failure);
    if (!is_scene_id(whole.filename().string()))
        return Error{
            ErrorCode::invalid_input,
            whole.string() + ": a scene's folder is named with 1 to 64 of letters, digits, '-', '_' and '.'"};
    const Error exists{ErrorCode::invalid_input,
                       whole.string() + ": is there already; remove it, or choose another folder with -o"};
    if (fs::exists(fs::symlink_status(whole, failure))) return exists;
    if (!fs::is_directory(whole.parent_path(), failure))
        return Error{ErrorCode::io_failure,
                     whole.parent_path().string() + ": is no folder; make it, or choose another with -o"};

    progress.advance("replaying edits", 0);
    const auto scene = load_scene(folder);
    if (!scene) return scene.error();
    const auto state = state_at(*scene, journal, revision, progress);
    if (!state) return state.error();

    // Beside its place, so that one rename puts it there; a hidden folder is no scene
    std::string place = (whole.parent_path() / ("." + whole.filename().string() + "-XXXXXX")).string();
    if (::mkdtemp(place.data()) == nullptr)
        return failed(whole.parent_path(), std::error_code{errno, std::generic_category()});
    const RemovedAtEnd made{place};
    const fs::path inside = made.folder / whole.filename();
    if (!fs::create_directory(inside, failure)) return failed(inside, failure);
    if (auto copied = copy_assets(folder, inside, progress); !copied) return copied;
    progress.advance("writing the scene file", 0);
    if (auto written = write_scene_file(folder / "scene.json", *state, inside / "scene.json"); !written)
        return written;
    progress.advance("checking", 0);
    if (const auto loaded = load_scene(inside); !loaded) return loaded.error();
    if (progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
    if (auto synced = sync_folder(inside); !synced) return synced;
    // Never over what came to be there meanwhile
    if (::renameat2(AT_FDCWD, inside.c_str(), AT_FDCWD, whole.c_str(), RENAME_NOREPLACE) != 0) {
        const std::error_code why{errno, std::generic_category()};
        if (why == std::errc::file_exists) return exists;
        // Not every file system knows how; a folder that is not empty is then left alone all the same
        if (why == std::errc::invalid_argument) fs::rename(inside, whole, failure);
        if (why != std::errc::invalid_argument || failure) return failed(whole, why);
    }
    return sync_folder(whole.parent_path());
}

}  // namespace tessera
