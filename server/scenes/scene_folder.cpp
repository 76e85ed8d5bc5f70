#include "server/scenes/scene_folder.h"

#include <algorithm>
#include <random>
#include <span>

#include "proto/scene.pb.h"

#include "server/files/whole_file.h"
#include "server/scene/asset_file.h"
#include "server/scene/scene.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_id = 64;

bool is_plain(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
}

/// The id is cut where it would be too long with the suffix behind it.
std::string suffixed(const std::string& id, const std::string& suffix) {
    return id.substr(0, longest_id - suffix.size()) + suffix;
}

Error failed(const fs::path& path, const std::error_code& failure, const char* fix) {
    return {ErrorCode::io_failure, path.string() + ": " + failure.message() + "; " + fix};
}

/// A new folder beside `target`. Its name is nobody else's, and no scene's, since it starts with a dot.
Result<fs::path> make_unfinished_folder(const fs::path& target) {
    std::error_code failure;
    fs::create_directories(target.parent_path(), failure);
    std::random_device random;
    fs::path made;
    do {
        made = target.parent_path() /
               ('.' + target.filename().string() + ".unfinished-" + std::to_string(random()));
    } while (!failure && !fs::create_directory(made, failure));
    if (failure) return failed(made, failure, "choose a folder that can be written with -o");
    return made;
}

Result<void> fill(const fs::path& folder, const proto::Scene& scene,
                  const std::function<Result<void>(const fs::path&)>& add_files) {
    if (auto added = add_files(folder); !added) return added;
    // Last, since a folder without it is no scene
    const std::string text = write_brief_json(scene);
    const std::span bytes{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
    if (auto written = write_whole_file(folder / "scene.json", bytes); !written) return written;
    return sync_folder(folder);
}

}  // namespace

std::string scene_id_of(const fs::path& photo) {
    std::string id;
    for (const char c : photo.stem().string()) {
        if (is_plain(c)) {
            id += c;
        } else if (!id.empty() && id.back() != '-') {
            id += '-';  // one for a run of spaces, brackets or bytes of another alphabet
        }
    }
    id.erase(0, id.find_first_not_of(".-"));
    id.resize(std::min(id.size(), longest_id));
    id.erase(id.find_last_not_of('-') + 1);
    return id.empty() ? "photo" : id;
}

std::string scene_id_of(const fs::path& photo, ExchangeMethod method) {
    const std::string id = scene_id_of(photo);
    return method == ExchangeMethod::content_exchange ? id
                                                      : suffixed(id, '-' + std::string{method_name(method)});
}

std::string numbered_id(const std::string& id, int number) {
    if (number == 1) return id;
    return suffixed(id, '-' + std::to_string(number));
}

Result<void> write_scene_folder(const fs::path& folder, const proto::Scene& scene,
                                const RecordedAsset* asset) {
    return write_scene_folder_with(folder, scene, [asset](const fs::path& inside) -> Result<void> {
        if (asset == nullptr) return {};
        return write_exchange_asset(inside / asset_folder_name, asset->asset, asset->preparation);
    });
}

Result<void> write_scene_folder_with(const fs::path& folder, const proto::Scene& scene,
                                     const std::function<Result<void>(const fs::path&)>& add_files) {
    std::error_code failure;
    if (fs::exists(folder, failure) && !fs::is_empty(folder, failure) &&
        !fs::exists(folder / "scene.json", failure))
        return Error{ErrorCode::invalid_input,
                     folder.string() + ": is there and is no scene; choose another folder with -o"};

    const fs::path target = fs::absolute(folder, failure).lexically_normal();
    const auto unfinished = make_unfinished_folder(target);
    if (!unfinished) return unfinished.error();
    const RemovedAtEnd made{*unfinished};
    if (auto done = fill(made.folder, scene, add_files); !done) return done;
    if (auto done = move_into_place(made.folder, target); !done) return done;
    return sync_folder(target.parent_path());
}

bool holds_valid_scene(const fs::path& folder) {
    std::error_code failure;
    return fs::exists(folder / "scene.json", failure) && load_scene(folder).has_value();
}

std::optional<Preparation> preparation_of(const fs::path& folder) {
    std::error_code failure;
    if (!fs::exists(folder / "scene.json", failure)) return std::nullopt;
    const auto made = read_preparation(folder / asset_folder_name);
    return made ? std::optional{*made} : std::nullopt;
}

bool was_made_of(const fs::path& folder, const Rgb8Image& photo, ExchangeMethod method) {
    const auto made = preparation_of(folder);
    if (!made || made->method != method) return false;
    if (!made->photo.empty()) return made->photo == photo_id(photo);
    // An asset of the version before that record
    const auto asset = read_exchange_asset(folder / asset_folder_name);
    return asset && asset->exemplar.width == photo.width && asset->exemplar.height == photo.height &&
           asset->exemplar.bytes == photo.bytes;
}

}  // namespace tessera
