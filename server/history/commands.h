#pragma once

namespace CLI {
class App;
}

namespace tessera {

/// Adds `tessera log` and `tessera export`. Their callbacks set `exit_code`.
void add_history_commands(CLI::App& app, int& exit_code);

}  // namespace tessera
