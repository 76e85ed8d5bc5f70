#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/stream.pb.h"

#include "client/link/server_address.h"

namespace tessera {

struct EditOptions {
    ServerAddress server;
    std::string scene;
    std::string token;                          ///< Of an editor; empty: none.
    std::string name;                           ///< Of who edits, for people.
    bool json = false;                          ///< JSON lines out, in place of sentences.
    std::chrono::milliseconds patience{30000};  ///< For an edit's fate.

    enum class Task {
        edit,   ///< Make `edit`, say what became of it.
        lines,  ///< Make the edits that standard input has, a line each.
        watch,  ///< Say what happens.
    };
    Task task = Task::edit;
    proto::Edit edit;

    // Of watch
    std::vector<proto::Window> windows;  ///< Whose invalidations are told; empty: those of the coarse levels.
    std::optional<std::uint64_t> edits;  ///< Ends after so many.
    std::optional<std::chrono::milliseconds> seconds;  ///< Ends after so long.
};

struct EditCommandLine {
    EditOptions options;
    bool go_on = false;  ///< False: everything is said, `exit_code` is the program's.
    int exit_code = 0;
};

/// Prints what is wrong, or help.
EditCommandLine read_edit_command_line(int argc, const char* const* argv);

}  // namespace tessera
