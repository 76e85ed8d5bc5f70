#include "server/scenes/scene_folder.h"

#include <algorithm>
#include <span>

#include "proto/scene.pb.h"

#include "server/scene/asset_file.h"
#include "server/scene/scene.h"
#include "server/scene/whole_file.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_id = 64;

bool is_plain(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
}

Error failed(const fs::path& path, const std::error_code& failure, const char* fix) {
    return {ErrorCode::io_failure, path.string() + ": " + failure.message() + "; " + fix};
}

Result<void> fill(const fs::path& folder, const proto::Scene& scene, const ContentExchangeAsset* asset,
                  std::uint64_t seed) {
    if (asset != nullptr)
        if (auto written = write_content_exchange_asset(folder / asset_folder_name, *asset, seed); !written)
            return written;
    // Last, since a folder without it is no scene
    const std::string text = write_json(scene);
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

Result<void> write_scene_folder(const fs::path& folder, const proto::Scene& scene,
                                const ContentExchangeAsset* asset, std::uint64_t seed) {
    std::error_code failure;
    if (fs::exists(folder, failure) && !fs::is_empty(folder, failure) &&
        !fs::exists(folder / "scene.json", failure))
        return Error{ErrorCode::invalid_input,
                     folder.string() + ": is there and is no scene; choose another folder with -o"};

    const fs::path parent = fs::absolute(folder, failure).parent_path();
    fs::path neighbour = parent / ".";  // a name that is no scene id
    (neighbour += folder.filename()) += ".unfinished";
    fs::remove_all(neighbour, failure);
    fs::create_directories(neighbour, failure);
    if (failure) return failed(neighbour, failure, "choose a folder that can be written with -o");
    if (auto filled = fill(neighbour, scene, asset, seed); !filled) {
        fs::remove_all(neighbour, failure);
        return filled;
    }
    fs::remove_all(folder, failure);
    if (!failure) fs::rename(neighbour, folder, failure);
    if (failure) return failed(folder, failure, "could not be replaced");
    return sync_folder(parent);
}

bool holds_valid_scene(const fs::path& folder) {
    std::error_code failure;
    return fs::exists(folder / "scene.json", failure) && load_scene(folder).has_value();
}

bool holds_scene_of(const fs::path& folder, const Rgb8Image& photo) {
    const auto asset = read_content_exchange_asset(folder / asset_folder_name);
    return asset && asset->exemplar.width == photo.width && asset->exemplar.height == photo.height &&
           asset->exemplar.bytes == photo.bytes && holds_valid_scene(folder);
}

}  // namespace tessera
