#pragma once

namespace CLI {
class App;
}

namespace tessera {

/// Adds `tessera accuracy` to the command line; running it leaves its result in `exit_code`: 0, or 1 after
/// one line on stderr that says what is wrong and how to mend it.
void add_accuracy_command(CLI::App& app, int& exit_code);

}  // namespace tessera
