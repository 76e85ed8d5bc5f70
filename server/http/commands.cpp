#include "server/http/commands.h"

#include <CLI/CLI.hpp>

namespace tessera {

void add_serve_command(CLI::App&, int&) {}

}  // namespace tessera
