#include "server/bake/commands.h"

#include <CLI/CLI.hpp>

namespace tessera {

void add_bake_commands(CLI::App&, int&) {}

}  // namespace tessera
