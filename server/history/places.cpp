#include "server/history/places.h"

#include <system_error>

#include "server/scene/scene.h"

namespace tessera {

namespace fs = std::filesystem;

Result<ScenePlaces> find_scene(const std::string& scene, const fs::path& scenes, const fs::path& edits) {
    std::error_code failure;
    ScenePlaces places;
    places.scene = scenes.empty() ? fs::path{scene} : scenes / scene;
    if (!scenes.empty() && fs::exists(scenes / "scene.json", failure)) places.scene = scenes;
    if (!fs::is_regular_file(places.scene / "scene.json", failure))
        return Error{
            ErrorCode::io_failure,
            places.scene.string() + ": is no scene; name its folder, or name it with --scenes FOLDER"};
    const fs::path whole = fs::absolute(places.scene, failure).lexically_normal();
    const fs::path folder = whole.has_filename() ? whole : whole.parent_path();
    places.id = folder.filename().string();
    if (!is_scene_id(places.id))
        return Error{ErrorCode::invalid_input, folder.string() + ": is not named as a scene"};
    if (!scenes.empty() && scene != places.id && fs::path{scene}.filename() != places.id)
        return Error{ErrorCode::invalid_input,
                     "--scenes " + scenes.string() + ": is the scene " + places.id + ", and not " + scene};
    if (!edits.empty()) {
        places.journal = edits / places.id;
        return places;
    }
    const fs::path beside = folder.parent_path() / ".edits" / places.id,
                   inside = folder / ".edits" / places.id;
    const bool has_both = fs::exists(beside, failure) && fs::exists(inside, failure);
    if (has_both)
        return Error{ErrorCode::invalid_input, "there are edits in " + beside.string() + " and in " +
                                                   inside.string() + "; say which with --edits"};
    places.journal = fs::exists(inside, failure) ? inside : beside;
    return places;
}

}  // namespace tessera
