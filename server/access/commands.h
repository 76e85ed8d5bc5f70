#pragma once

namespace CLI {
class App;
}

namespace tessera {

/// Adds `tessera token`. Its callback sets `exit_code`.
void add_token_command(CLI::App& app, int& exit_code);

}  // namespace tessera
