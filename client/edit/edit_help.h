#pragma once

namespace CLI {
class App;
}

namespace tessera {

inline constexpr const char* edit_description =
    "Changes a scene while it is served, and follows what others change.";

/// Gives the program and each of its subcommands, which are there, a usage line that can be typed as it
/// stands, and examples.
void add_edit_help(CLI::App& app);

}  // namespace tessera
