#include "server/prepare/commands.h"

#include <CLI/CLI.hpp>

namespace tessera {

void add_prepare_command(CLI::App&, int&) {}

}  // namespace tessera
