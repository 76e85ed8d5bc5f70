#include "server/tiled/import_map.h"

#include <span>

#include "server/files/whole_file.h"
#include "server/scene/scene.h"
#include "server/scenes/scene_folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr const char* report_name = "import.txt";

Result<void> add_files(const fs::path& folder, const TiledScene& scene) {
    for (const auto& sheet : scene.sheets)
        if (auto written = write_rgba_png(folder / sheet.file, sheet.image); !written) return written;
    for (const auto& map : scene.maps)
        if (auto written = write_label_png(folder / map.file, map.image); !written) return written;
    const std::string report = scene.report();
    return write_whole_file(folder / report_name,
                            {reinterpret_cast<const std::uint8_t*>(report.data()), report.size()});
}

}  // namespace

Result<TiledScene> import_tiled_map(const fs::path& map, const fs::path& folder, const std::string& title,
                                    Progress& progress) {
    if (!is_scene_id(folder.filename().string()))
        return Error{ErrorCode::invalid_input,
                     folder.string() +
                         ": a scene's folder is named with 1 to 64 of letters, digits, '-', '_' "
                         "and '.'; choose another with -o"};
    progress.advance("reading", 0);
    const auto read = read_tiled_map(map);
    if (!read) return read.error();
    progress.advance("painting", 0);
    auto scene = to_scene(*read, title.empty() ? map.stem().string() : title, progress);
    if (!scene) return Error{scene.error().code, map.string() + ": " + scene.error().detail};
    progress.advance("writing", 0);
    if (auto written = write_scene_folder_with(
            folder, scene->scene, [&](const fs::path& inside) { return add_files(inside, *scene); });
        !written)
        return written.error();
    progress.advance("checking", 0);
    if (const auto loaded = load_scene(folder); !loaded) return loaded.error();
    progress.advance("checking", 1);
    return scene;
}

}  // namespace tessera
