#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "server/prepare/recorded.h"
#include "shared/result/result.h"

namespace tessera::proto {
class Scene;
}

namespace tessera {

/// The id of a scene made of a photograph: its file name without extension, all but letters, digits, '-',
/// '_' and '.' replaced, at most 64 characters; "photo" if nothing is left.
std::string scene_id_of(const std::filesystem::path& photo);

/// The same with "-interchange" or "-wang" behind it, for what is made by these methods.
std::string scene_id_of(const std::filesystem::path& photo, ExchangeMethod method);

/// "wall", "wall-2", "wall-3", … for 1, 2, 3, …: ids for pictures of one name. `id` is cut where the suffix
/// would make it longer than 64 characters.
std::string numbered_id(const std::string& id, int number);

/// The folder inside a scene's folder that holds its asset.
inline constexpr const char* asset_folder_name = "asset";

/// Writes `folder` with a scene file and, unless it is null, the asset that the scene file names; whole or
/// not at all: a neighbour that is moved into place. What was there is replaced, if it was a scene. Errors:
/// io_failure, invalid_input (a folder that is there and no scene).
Result<void> write_scene_folder(const std::filesystem::path& folder, const proto::Scene& scene,
                                const RecordedAsset* asset);

/// The same, with what `add_files` writes into the folder that it is given.
Result<void> write_scene_folder_with(
    const std::filesystem::path& folder, const proto::Scene& scene,
    const std::function<Result<void>(const std::filesystem::path&)>& add_files);

/// Whether `folder` holds a scene that loads.
bool holds_valid_scene(const std::filesystem::path& folder);

/// What a scene folder says of its asset's making; nothing if it has no asset of ours, or none that says so.
std::optional<Preparation> preparation_of(const std::filesystem::path& folder);

/// Whether `folder` has a scene file, whatever it says now, and an asset of exactly this photograph for this
/// method.
bool was_made_of(const std::filesystem::path& folder, const Rgb8Image& photo, ExchangeMethod method);

}  // namespace tessera
