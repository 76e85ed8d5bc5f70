#include "server/scenes/commands.h"

#include <CLI/CLI.hpp>

namespace tessera {

void add_scenes_command(CLI::App&, int&) {}

}  // namespace tessera
