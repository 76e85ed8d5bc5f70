#include "server/tiled/commands.h"

#include <cstdio>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>

#include "server/progress/interrupt.h"
#include "server/progress/terminal_progress.h"
#include "server/tiled/import_map.h"

namespace tessera {
namespace {

struct Arguments {
    std::string map;
    std::string output;
    std::string title;
    bool quiet = false;
};

Result<TiledScene> run(const Arguments& arguments) {
    const Interrupt interrupt;
    TerminalProgress progress{"tessera import",
                              {{"reading", 0.2}, {"painting", 0.5}, {"writing", 0.2}, {"checking", 0.1}},
                              arguments.quiet,
                              interrupt.token()};
    std::filesystem::path folder = arguments.output;
    if (!folder.has_filename()) folder = folder.parent_path();  // "scene/" is "scene"
    return import_tiled_map(arguments.map, folder, arguments.title, progress);
}

}  // namespace

void add_import_command(CLI::App& app, int& exit_code) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App& command = *app.add_subcommand("import", "Makes a scene of a map of the Tiled editor (.tmx)");
    command.footer(
        "Layers of tiles become reference textures over explicit indirection maps, one over the other; tiles "
        "at\n"
        "free places become sprites over them; tile probabilities, complete terrains and animations become\n"
        "blocks to go on with. What a scene cannot hold is listed, and written to import.txt beside the "
        "scene "
        "file.");
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
            std::printf("%s", done->report().c_str());
    });
}

}  // namespace tessera
