// One command, `tessera`: each room adds the subcommands it answers for.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <google/protobuf/stubs/logging.h>

#include "server/access/commands.h"
#include "server/accuracy/commands.h"
#include "server/bake/commands.h"
#include "server/compare/commands.h"
#include "server/history/commands.h"
#include "server/http/commands.h"
#include "server/prepare/commands.h"
#include "server/progress/interrupt.h"
#include "server/scenes/commands.h"
#include "server/tiled/commands.h"
#include "shared/result/in_quotes.h"
#include "shared/result/nearest_name.h"

int main(int argc, char** argv) {
    CLI::App app{"Tessera: evaluates endless textures page by page, exactly filtered, and streams them."};
    app.require_subcommand(1);
    app.set_help_all_flag("--help-all", "Help of every subcommand");
    app.set_version_flag("--version", std::string{"tessera "} + TESSERA_VERSION);
    // What clients send wrongly is told them in our words; lines on stderr would come at anybody's will
    google::protobuf::SetLogHandler(nullptr);
    int exit_code = 0;
    tessera::add_serve_command(app, exit_code);
    tessera::add_token_command(app, exit_code);
    tessera::add_history_commands(app, exit_code);  // log, export
    tessera::add_prepare_command(app, exit_code);   // prepare, report
    tessera::add_bake_commands(app, exit_code);     // page, bake, check
    tessera::add_compare_commands(app, exit_code);  // quality, compare
    tessera::add_accuracy_command(app, exit_code);  // accuracy
    tessera::add_scenes_command(app, exit_code);    // samples
    tessera::add_import_command(app, exit_code);    // import
    std::vector<std::string> commands;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        commands.push_back(command->get_name());
    if (argc > 1 && argv[1][0] != '-' && std::ranges::find(commands, argv[1]) == commands.end()) {
        const std::string meant = tessera::nearest_name(argv[1], commands);
        std::fprintf(stderr, "tessera: there is no command %s; %s\n", tessera::in_quotes(argv[1]).c_str(),
                     meant.empty() ? "tessera --help lists them" : ("did you mean " + meant + "?").c_str());
        return 2;
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& wrong) {
        // Help and version end here too; what is wrong is said in the parser's words
        return app.exit(wrong) == 0 ? 0 : 2;
    } catch (const std::bad_alloc&) {
        std::fputs("tessera: there is not enough memory; take a smaller image or texture\n", stderr);
        return 1;
    } catch (const std::exception& failed) {
        std::fprintf(stderr, "tessera: %s\n", failed.what());
        return 1;
    }
    const int signal = tessera::Interrupt::signal_that_came();
    return signal != 0 && exit_code == 1 ? 128 + signal : exit_code;
}
