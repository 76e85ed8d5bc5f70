#include "server/scenes/painted_folder.h"

#include <algorithm>
#include <span>

#include "server/files/whole_file.h"
#include "server/scene/digest.h"
#include "server/scenes/scene_folder.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

/// Beside scene.json: the version that painted, and the digest of the scene file that it wrote.
constexpr const char* record_name = "painted.txt";

Result<void> write_text(const fs::path& file, const std::string& text) {
    return write_whole_file(file, std::span{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::string record_of(const std::string& scene_text) {
    Digest digest;
    digest.add(scene_text.data(), scene_text.size());
    return std::to_string(painting_version) + ' ' + digest.hex() + '\n';
}

}  // namespace

Standing standing_of(const fs::path& folder) {
    if (!holds_valid_scene(folder)) return Standing::absent;
    const auto record = read_whole_file(folder / record_name, 256);
    const auto scene = read_whole_file(folder / "scene.json", std::int64_t{1} << 24);
    if (!record || !scene) return Standing::current;
    const std::string now = record_of(*scene);
    if (*record == now) return Standing::current;
    // Another version, and the very scene file that it wrote
    const auto digest = [](const std::string& text) {
        return text.substr(std::min(text.find(' '), text.size()));
    };
    return digest(*record) == digest(now) ? Standing::outdated : Standing::current;
}

Result<void> write_painted_folder(const fs::path& folder, const PaintedScene& painted,
                                  const std::function<Result<void>(const fs::path&)>& add_ground) {
    return write_scene_folder_with(folder, painted.scene, [&](const fs::path& inside) -> Result<void> {
        if (painted.on_pebbles)
            if (auto added = add_ground(inside); !added) return added;
        for (const PaintedFile& file : painted.files)
            if (auto written = write_whole_file(inside / file.name, file.bytes); !written) return written;
        return write_text(inside / record_name, record_of(write_brief_json(painted.scene)));
    });
}

}  // namespace tessera
