#include "server/access/commands.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "server/access/token.h"

namespace tessera {

namespace {

struct Arguments {
    std::string name;
    std::string role;
    std::string expires;
    std::string file;
};

Result<void> run(const Arguments& arguments) {
    if (auto named = check_holder_name(arguments.name); !named) return named;
    if (!arguments.expires.empty()) {
        const auto day = expiry_from(arguments.expires);
        if (!day) return day.error();
        // In seconds: nanoseconds end in the year 2262
        const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
        if (*day + std::chrono::days{1} <= now)
            return Error{ErrorCode::invalid_input,
                         "--expires " + arguments.expires +
                             ": is over; name the last day on which the token is to be good"};
    }
    const std::string token = make_token();
    const std::string line = token_line(arguments.role, arguments.name, token, arguments.expires);
    if (arguments.file.empty()) {
        std::fprintf(
            stderr,
            "tessera token: give the first line to %s, it is not shown again; the second goes into the file "
            "that tessera serve --tokens names\n",
            arguments.name.c_str());
        std::printf("%s\n%s\n", token.c_str(), line.c_str());
    } else {
        if (auto added = add_token_line(arguments.file, line); !added) return added;
        std::fprintf(
            stderr,
            "tessera token: give this to %s, it is not shown again; a running server reads %s at SIGHUP\n",
            arguments.name.c_str(), arguments.file.c_str());
        std::printf("%s\n", token.c_str());
    }
    if (std::fflush(stdout) == 0) return {};
    return Error{ErrorCode::io_failure, "the token could not be shown; make another"};
}

}  // namespace

void add_token_command(CLI::App& app, int& exit_code) {
    auto* command = app.add_subcommand("token", "Makes a token with which somebody may edit from elsewhere");
    const auto arguments = std::make_shared<Arguments>();
    command->add_option("NAME", arguments->name, "Who gets it; stands in the log of edits")->required();
    command
        ->add_option("--role", arguments->role,
                     "editor, or viewer, which may do nothing yet that others may not")
        ->required()
        ->check(CLI::IsMember({"editor", "viewer"}));
    command->add_option("--expires", arguments->expires, "Its last day, in UTC: YYYY-MM-DD (default: none)");
    command->add_option("--file", arguments->file,
                        "Add its hash to this file, for tessera serve --tokens (default: print the line)");
    command->callback([arguments, &exit_code] {
        if (const auto made = run(*arguments); !made) {
            std::fprintf(stderr, "tessera token: %s\n", made.error().detail.c_str());
            exit_code = 1;
        }
    });
}

}  // namespace tessera
