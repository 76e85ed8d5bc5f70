#include "server/tiled/commands.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>

#include <CLI/CLI.hpp>

#include "server/progress/interrupt.h"
#include "server/progress/terminal_progress.h"
#include "server/scene/scene.h"
#include "server/scene/whole_file.h"
#include "server/scenes/scene_folder.h"
#include "server/tiled/tiled_map.h"
#include "server/tiled/tiled_scene.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr const char* report_name = "import.txt";

struct Arguments {
    std::string map;
    std::string output;
    std::string title;
    bool quiet = false;
};

Result<void> add_files(const fs::path& folder, const TiledScene& scene) {
    for (const auto& sheet : scene.sheets)
        if (auto written = write_rgba_png(folder / sheet.file, sheet.image); !written) return written;
    for (const auto& map : scene.maps)
        if (auto written = write_label_png(folder / map.file, map.image); !written) return written;
    const std::string report = scene.report();
    return write_whole_file(folder / report_name,
                            {reinterpret_cast<const std::uint8_t*>(report.data()), report.size()});
}

/// The report.
Result<std::string> run(const Arguments& arguments) {
    const Interrupt interrupt;
    TerminalProgress progress{"tessera import",
                              {{"reading", 0.2}, {"painting", 0.5}, {"writing", 0.2}, {"checking", 0.1}},
                              arguments.quiet,
                              interrupt.token()};
    progress.advance("reading", 0);
    const auto map = read_tiled_map(arguments.map);
    if (!map) return map.error();
    progress.advance("painting", 0);
    const std::string title =
        arguments.title.empty() ? fs::path{arguments.map}.stem().string() : arguments.title;
    const auto scene = to_scene(*map, title, progress);
    if (!scene) return Error{scene.error().code, arguments.map + ": " + scene.error().detail};
    progress.advance("writing", 0);
    fs::path folder = arguments.output;
    if (!folder.has_filename()) folder = folder.parent_path();  // "scene/" is "scene"
    if (auto written = write_scene_folder_with(
            folder, scene->scene, [&](const fs::path& inside) { return add_files(inside, *scene); });
        !written)
        return written.error();
    progress.advance("checking", 0);
    if (const auto loaded = load_scene(folder); !loaded) return loaded.error();
    progress.advance("checking", 1);
    return scene->report();
}

}  // namespace

void add_import_command(CLI::App& app, int& exit_code) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App& command = *app.add_subcommand("import", "Makes a scene of a map of the Tiled editor (.tmx)");
    command.footer(
        "Layers of tiles become reference textures over explicit indirection maps, one over the other; tile\n"
        "probabilities, complete terrains and animations become blocks to go on with. What a scene cannot "
        "hold\n"
        "is listed, and written to import.txt beside the scene file.");
    command.add_option("MAP", arguments->map, "An orthogonal map, finite or infinite")->required();
    command.add_option("-o,--output", arguments->output, "Folder of the scene; a scene there is replaced")
        ->required();
    command.add_option("--title", arguments->title, "For people (default: the map's name)");
    command.add_flag("-q,--quiet", arguments->quiet, "Say nothing but errors");
    command.callback([arguments, &exit_code] {
        const auto done = run(*arguments);
        exit_code = done ? 0 : 1;
        if (!done)
            std::fprintf(stderr, "tessera import: %s\n", done.error().detail.c_str());
        else if (!arguments->quiet)
            std::printf("%s", done->c_str());
    });
}

}  // namespace tessera
