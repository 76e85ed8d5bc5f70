// One command, `tessera`: each room adds the subcommands it answers for.
#include <CLI/CLI.hpp>

#include "server/bake/commands.h"
#include "server/http/commands.h"
#include "server/prepare/commands.h"
#include "server/scenes/commands.h"

int main(int argc, char** argv) {
    CLI::App app{"Tessera: evaluates endless textures page by page, exactly filtered, and streams them."};
    app.require_subcommand(1);
    app.set_help_all_flag("--help-all", "Help of every subcommand");
    app.set_version_flag("--version", std::string{"tessera "} + TESSERA_VERSION);
    int exit_code = 0;
    tessera::add_serve_command(app, exit_code);
    tessera::add_prepare_command(app, exit_code);
    tessera::add_bake_commands(app, exit_code);   // page, bake, check
    tessera::add_scenes_command(app, exit_code);  // samples
    CLI11_PARSE(app, argc, argv);
    return exit_code;
}
