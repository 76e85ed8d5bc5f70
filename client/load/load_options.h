#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/load/assertion.h"
#include "client/load/load_run.h"

namespace tessera {

/// What the command line of tessera-load says, checked as far as that goes without asking the server.
struct LoadOptions {
    ServerAddress server;
    std::string scene;
    std::string walk = "random";  ///< random, sweep or camera
    std::string levels;           ///< As parse_level_weights() reads it.
    std::size_t working_set = 0;
    std::uint32_t sweep_side = 16;
    std::string camera_file;  ///< Empty: a generated flight.
    std::uint64_t seed = 1;
    LoadPlan plan;          ///< Without server and scene.
    std::string json_file;  ///< Empty: none; "-": stdout, instead of the summary.
    bool quiet = false;
    std::vector<Assertion> assertions;
};

/// What main does next.
struct CommandLine {
    LoadOptions options;
    bool go_on = false;
    int exit_code = 0;  ///< If not: 0 after --help and --version, 2 after a message on stderr.
};
CommandLine read_command_line(int argc, const char* const* argv);

}  // namespace tessera
