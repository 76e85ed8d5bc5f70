#include "client/edit/edit_help.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>

namespace tessera {
namespace {

constexpr const char* of_the_program = R"(
Examples:
  tessera-edit http://127.0.0.1:7070 road place 4000 2500 --pattern 2 --id 700
      puts sprite 700 there, its middle at texel (4000, 2500) of level 0
  tessera-edit http://127.0.0.1:7070 road move 700 4100 2500 --turn 0.25
  tessera-edit http://127.0.0.1:7070 road --json remove 700 >> done.jsonl
  tessera-edit http://127.0.0.1:7070 road undo done.jsonl
      takes the last edit of that file back
  tessera-edit http://127.0.0.1:7070 road watch --seconds 60
  tessera-edit paint --help
      shows what a command takes, with examples

An edit is sent until its fate is known: over a lost connection, or a server that starts anew, under the same id, so
that it is in once.

Exit codes: 0 done; 1 the server cannot be reached, or has no such scene; 2 wrong command line; 3 an edit was refused;
4 nobody knows whether an edit is in; 130 interrupted.)";

/// What follows "tessera-edit http://127.0.0.1:7070 ", a line each; lines that begin with a space explain.
constexpr std::pair<const char*, const char*> examples[]{
    {"place", R"(road place 4000 2500
      pattern 0 with its middle at texel (4000, 2500) of level 0, under a number that is drawn and told
road place 4000 2500 --pattern 2 --id 700 --scale 1.5 --turn 0.25
      sprite 700, half as large again, turned by a quarter
road place 4000 2500 --first-step 100 --end-step 160
      there from step 100 of the clock to before step 160)"},
    {"move", R"(road move 700 4100 2500
road move 700 --turn 0.5 --order 9
      stays where it is, upside down, above sprites of lower order)"},
    {"remove", R"(road remove 700
road remove 701 702 703
      in one edit: all of them or none)"},
    {"paint", R"(meadow-sand paint areas 4 4 8 8 1
      writes 1 into 8 × 8 entries of the map "areas", from column 4 and row 4 on
meadow-sand paint areas 4 4 8 8 1 --disc)"},
    {"set", R"(flower-field set open target_distance.near_texels 12
      the blocks and fields that may be set: GET /scenes/flower-field/editables)"},
    {"animate", R"(message-board animate lit --density 0.8
message-board animate lit --density 0.8 --step 4000
      from step 4000 of the clock on, without a jump)"},
    {"target", R"(flower-field target 1 131000 131200
flower-field target 1 --remove)"},
    {"clock", R"(message-board clock pause --step 100
      for everybody who looks at the scene
message-board clock play --rate 20)"},
    {"apply", R"(road apply edit.json
      where edit.json holds {"changes": [{"move_sprite": {"id": 7, "x": 10, "y": 20}}]})"},
    {"undo", R"(road --json remove 700 >> done.jsonl
road undo done.jsonl
      takes the last edit of that file back)"},
    {"lines", R"(road lines < edits.jsonl
      each line of standard input is an edit: {"changes": [{"move_sprite": {"id": 7, "x": 10, "y": 20}}]};
      each line of standard output is what became of one, in the order in which that was known)"},
    {"watch", R"(road watch --seconds 60
      a JSON line for each edit, stale pages, people and the clock, as proto/stream.proto's ServerMessage has them
road watch --window 0:4,4,12,8 --edits 1
      until one edit was made, with news of the pages 4 to 11 by 4 to 7 of level 0)"},
};

/// Subcommands are written behind the server and the scene.
class UsageFormatter final : public CLI::Formatter {
    std::string make_usage(const CLI::App* app, std::string name) const override {
        return Formatter::make_usage(
            app, app->get_parent() == nullptr ? name : "tessera-edit URL SCENE " + app->get_name());
    }
};

std::string footer_of(const std::string& lines) {
    std::string text = "\nExamples:\n";
    for (std::size_t at = 0; at < lines.size();) {
        const std::size_t end = std::min(lines.find('\n', at), lines.size());
        if (lines[at] != ' ') text += "  tessera-edit http://127.0.0.1:7070 ";
        text += lines.substr(at, end - at) + "\n";
        at = end + 1;
    }
    return text +
           "\nOptions that every command takes, such as --json and --base, and exit codes: tessera-edit "
           "--help";
}

}  // namespace

void add_edit_help(CLI::App& app) {
    app.footer(of_the_program);
    const auto formatter = std::make_shared<UsageFormatter>();
    app.formatter(formatter);
    for (const auto& [name, lines] : examples) {
        CLI::App& command = *app.get_subcommand(name);
        command.formatter(formatter);
        command.footer(footer_of(lines));
    }
}

}  // namespace tessera
