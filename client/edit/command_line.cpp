#include "client/edit/command_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>
#include <string_view>

#include <CLI/CLI.hpp>

#include "client/edit/edit_help.h"
#include "client/edit/edit_json.h"

namespace tessera {
namespace {

constexpr std::size_t most_text = std::size_t{1} << 20;

/// An integer, a number, or a block's name.
proto::Value value_of(const std::string& text) {
    proto::Value value;
    std::int64_t integer = 0;
    const char* end = text.data() + text.size();
    if (const auto read = std::from_chars(text.data(), end, integer);
        read.ec == std::errc{} && read.ptr == end) {
        value.set_integer(integer);
        return value;
    }
    char* stopped = nullptr;
    const double number = std::strtod(text.c_str(), &stopped);
    if (stopped == text.c_str() + text.size() && std::isfinite(number))
        value.set_number(number);
    else
        value.set_block(text);
    return value;
}

/// A number that no other sprite has, most likely; JSON readers that know doubles alone can hold it.
std::uint64_t drawn_id() {
    std::random_device source;
    const std::uint64_t drawn = std::uint64_t{source()} << 32 | source();
    return (drawn >> 12) | 1;
}

/// The largest ellipse in the rectangle, a bit an entry.
std::string disc(std::uint32_t width, std::uint32_t height) {
    std::string mask((std::size_t{width} * height + 7) / 8, '\0');
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const double u = (2.0 * x + 1) / width - 1, v = (2.0 * y + 1) / height - 1;
            const std::size_t bit = std::size_t{y} * width + x;
            if (u * u + v * v <= 1) mask[bit / 8] = static_cast<char>(mask[bit / 8] | 1 << (bit % 8));
        }
    return mask;
}

/// "LEVEL:X0,Y0,X1,Y1"
std::optional<proto::Window> window_of(const std::string& text) {
    unsigned level = 0;
    long long x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int used = 0;
    if (std::sscanf(text.c_str(), "%u:%lld,%lld,%lld,%lld%n", &level, &x0, &y0, &x1, &y1, &used) != 5 ||
        static_cast<std::size_t>(used) != text.size() || level > 30 || x0 < 0 || y0 < 0 || x1 <= x0 ||
        y1 <= y0)
        return std::nullopt;
    proto::Window window;
    window.set_level(level);
    window.set_x0(x0);
    window.set_y0(y0);
    window.set_x1(x1);
    window.set_y1(y1);
    return window;
}

/// The subcommands, and what they leave in `options`.
class Commands {
  public:
    Commands(CLI::App& app, EditOptions& options) : options_{options} {
        add_sprite_commands(app);
        add_map_commands(app);
        add_time_commands(app);
        add_other_commands(app);
    }

    /// After the command line was read. What is wrong with it, or "".
    std::string finish() {
        for (const auto& [command, make] : makers_)
            if (command->parsed()) return make();
        return "";
    }

  private:
    template <class Make>
    CLI::App* add(CLI::App& app, const char* name, const char* what, Make make) {
        CLI::App* command = app.add_subcommand(name, what);
        makers_.emplace_back(command, [make]() -> std::string { return make(); });
        return command;
    }
    proto::Change& change() { return *options_.edit.add_changes(); }

    void add_sprite_commands(CLI::App& app) {
        CLI::App* place = add(app, "place", "Place a sprite", [this] {
            proto::SpritePlacement& sprite = *change().mutable_place_sprite();
            sprite.set_id(id_ != 0 ? id_ : drawn_id());
            sprite.set_x(x_.value_or(0));
            sprite.set_y(y_.value_or(0));
            sprite.set_pattern(pattern_.value_or(0));
            if (scale_) sprite.set_scale(*scale_);
            if (turn_) sprite.set_turn(*turn_);
            if (order_) sprite.set_order(*order_);
            if (first_step_) sprite.set_first_step(*first_step_);
            if (end_step_) sprite.set_end_step(*end_step_);
            return "";
        });
        place->add_option("X", x_, "Its middle, in texels of level 0")->required();
        place->add_option("Y", y_, "Its middle, in texels of level 0")->required();
        place->add_option("--id", id_, "Its number, not 0; drawn if not given");
        place->add_option("--first-step", first_step_, "There from this step of the clock on");
        place->add_option("--end-step", end_step_, "And before this one");
        CLI::App* move = add(app, "move", "Move, scale, turn or change a sprite", [this]() -> std::string {
            if (x_.has_value() != y_.has_value()) return "move: X and Y go together";
            proto::SpriteMove& sprite = *change().mutable_move_sprite();
            sprite.set_id(id_);
            if (x_) sprite.set_x(*x_);
            if (y_) sprite.set_y(*y_);
            if (scale_) sprite.set_scale(*scale_);
            if (turn_) sprite.set_turn(*turn_);
            if (order_) sprite.set_order(*order_);
            if (pattern_) sprite.set_pattern(*pattern_);
            return "";
        });
        move->add_option("ID", id_, "The sprite's number")->required();
        move->add_option("X", x_, "Where its middle goes; left out: it stays");
        move->add_option("Y", y_);
        for (CLI::App* command : {place, move}) {
            command->add_option("--pattern", pattern_, "Index of what it looks like");
            command->add_option("--scale", scale_, "1/64 to 4; 1 is its pattern's own size");
            command->add_option("--turn", turn_, "Turns, clockwise, from 0 to 1");
            command->add_option("--order", order_, "The greater, the nearer to the eye");
        }
        CLI::App* remove = add(app, "remove", "Remove sprites", [this] {
            for (const std::uint64_t id : ids_) change().mutable_remove_sprite()->set_id(id);
            return "";
        });
        remove->add_option("ID", ids_, "The sprites' numbers")->required();
    }

    void add_map_commands(CLI::App& app) {
        CLI::App* paint =
            add(app, "paint", "Write a value into a rectangle of a stored map", [this]() -> std::string {
                if (std::uint64_t{width_} * height_ > 65536) return "paint: at most 65,536 entries in all";
                proto::MapPaint& map = *change().mutable_paint_map();
                map.set_block(block_);
                map.set_x(column_);
                map.set_y(row_);
                map.set_width(width_);
                map.set_height(height_);
                map.set_value(entry_);
                if (disc_) map.set_mask(disc(width_, height_));
                return "";
            });
        paint->add_option("BLOCK", block_, "The map's block")->required();
        paint->add_option("X", column_, "The rectangle's first column of entries")->required();
        paint->add_option("Y", row_, "Its first row")->required();
        paint->add_option("WIDTH", width_, "Entries")->required()->check(CLI::Range(1, 65536));
        paint->add_option("HEIGHT", height_, "Entries")->required()->check(CLI::Range(1, 65536));
        paint->add_option("VALUE", entry_, "What is written; -1 is blank")->required();
        paint->add_flag("--disc", disc_, "Only inside the largest ellipse of the rectangle");

        CLI::App* set = add(app, "set", "Set a parameter of a block", [this] {
            proto::ParameterChange& parameter = *change().mutable_set_parameter();
            parameter.set_block(block_);
            parameter.set_field(field_);
            *parameter.mutable_value() = value_of(value_);
            return "";
        });
        set->add_option("BLOCK", block_, "The block; '' for fields of the scene, such as seed")->required();
        set->add_option("FIELD", field_, "As in the scene file, such as count or entries[0].weight")
            ->required();
        set->add_option("VALUE", value_, "A number, or a block's name where the field takes one")->required();
    }

    void add_time_commands(CLI::App& app) {
        CLI::App* animate =
            add(app, "animate", "Change an animation's parameters without a jump", [this]() -> std::string {
                proto::AnimationChange& animation = *change().mutable_change_animation();
                animation.set_block(block_);
                if (step_) animation.set_step(*step_);
                if (!phase_.empty()) *animation.mutable_phase() = value_of(phase_);
                if (!rest_.empty()) *animation.mutable_rest() = value_of(rest_);
                if (density_) animation.set_density(*density_);
                if (phase_.empty() && rest_.empty() && !density_)
                    return "animate: --phase, --rest or --density";
                return "";
            });
        animate->add_option("BLOCK", block_, "The animation's block")->required();
        animate->add_option("--phase", phase_, "A number, or a block's name");
        animate->add_option("--rest", rest_, "A number, or a block's name");
        animate->add_option("--density", density_, "The global density a");
        animate->add_option("--step", step_, "From this step on; left out: from now on");

        CLI::App* target = add(app, "target", "Set, move or remove a target", [this]() -> std::string {
            if (remove_) {
                change().mutable_remove_target()->set_id(id_);
                return "";
            }
            if (!x_ || !y_) return "target: X and Y, or --remove";
            proto::Target& set_target = *change().mutable_set_target();
            set_target.set_id(id_);
            set_target.set_x(std::llround(*x_));
            set_target.set_y(std::llround(*y_));
            return "";
        });
        target->add_option("ID", id_, "The target's number")->required();
        target->add_option("X", x_, "Texels of level 0");
        target->add_option("Y", y_);
        target->add_flag("--remove", remove_, "There is no such target any more");

        CLI::App* clock = add(app, "clock", "Play, pause, seek, or change the rate", [this]() -> std::string {
            proto::ClockChange& set_clock = *change().mutable_set_clock();
            if (!mode_.empty()) set_clock.set_playing(mode_ == "play");
            if (step_) set_clock.set_step(*step_);
            if (rate_) set_clock.set_steps_per_second(*rate_);
            if (mode_.empty() && !step_ && !rate_) return "clock: play, pause, --step or --rate";
            return "";
        });
        clock->add_option("MODE", mode_, "play or pause")->check(CLI::IsMember({"play", "pause"}));
        clock->add_option("--step", step_, "Go to this step");
        clock->add_option("--rate", rate_, "Steps a second")->check(CLI::Range(1e-3, 1000.0));
    }

    void add_other_commands(CLI::App& app) {
        const auto take = [this](const Result<proto::Edit>& edit) -> std::string {
            if (!edit) return edit.error().detail;
            options_.edit = *edit;
            return "";
        };
        CLI::App* apply =
            add(app, "apply", "Make an edit that a file has as JSON", [this, take]() -> std::string {
                const auto text = text_of(file_, most_text);
                return text ? take(edit_in(*text, file_)) : text.error().detail;
            });
        CLI::App* undo =
            add(app, "undo", "Take the last edit of a file of answers back", [this, take]() -> std::string {
                const auto text = text_of(file_, most_text);
                return text ? take(undo_in(*text, file_)) : text.error().detail;
            });
        for (CLI::App* command : {apply, undo})
            command->add_option("FILE", file_, "The file; -: standard input")->capture_default_str();
        add(app, "lines", "Make the edits of standard input, a line of JSON each", [this] {
            options_.task = EditOptions::Task::lines;
            return "";
        });
        CLI::App* watch = add(app, "watch", "Say what happens, a line of JSON each", [this]() -> std::string {
            options_.task = EditOptions::Task::watch;
            if (seconds_) options_.seconds = std::chrono::milliseconds{std::llround(*seconds_ * 1000)};
            for (const std::string& text : windows_) {
                const auto window = window_of(text);
                if (!window) return "--window " + text + ": write LEVEL:X0,Y0,X1,Y1, as in 0:4,4,12,8";
                options_.windows.push_back(*window);
            }
            return "";
        });
        watch->add_option(
            "--window", windows_,
            "Pages whose changes are told: LEVEL:X0,Y0,X1,Y1 (the last two excluded); the coarse levels "
            "if not given");
        watch->add_option("--edits", options_.edits, "End after so many edits");
        watch->add_option("--seconds", seconds_, "End after so long")->check(CLI::Range(0.001, 1e6));
    }

    EditOptions& options_;
    std::vector<std::pair<CLI::App*, std::function<std::string()>>> makers_;
    std::uint64_t id_ = 0;
    std::vector<std::uint64_t> ids_;
    std::optional<double> x_, y_, scale_, turn_, density_, rate_, seconds_;
    std::optional<std::int32_t> order_;
    std::optional<std::uint32_t> pattern_;
    std::optional<std::int64_t> first_step_, end_step_, step_;
    std::string block_, field_, value_, phase_, rest_, mode_, file_ = "-";
    std::int64_t column_ = 0, row_ = 0;
    std::uint32_t width_ = 0, height_ = 0;
    std::int32_t entry_ = 0;
    bool disc_ = false, remove_ = false;
    std::vector<std::string> windows_;
};

}  // namespace

EditCommandLine read_edit_command_line(int argc, const char* const* argv) {
    EditCommandLine line;
    EditOptions& options = line.options;
    std::string url, token_file;
    std::optional<std::uint64_t> base_revision;
    double patience = 30;

    CLI::App app{edit_description, "tessera-edit"};
    app.set_version_flag("--version", TESSERA_VERSION);
    app.add_option("URL", url, "The server, as in http://127.0.0.1:7070")->required();
    app.add_option("SCENE", options.scene, "The scene's id")->required();
    app.add_option("--token-file", token_file, "A file with an editor's token, for servers elsewhere");
    app.add_option("--name", options.name, "Who edits, for people; at most 64 bytes");
    app.add_flag("--json", options.json, "Say what became of the edit as a line of JSON, with its inverse");
    app.add_option("--base", base_revision, "Make the edit only while this is the scene's revision");
    app.add_option("--patience", patience, "Seconds after which an edit without an answer is given up")
        ->check(CLI::Range(0.1, 86'400.0))
        ->capture_default_str();
    app.require_subcommand(1);
    app.fallthrough();
    Commands commands{app, options};
    add_edit_help(app);

    const auto fail = [&](const std::string& why) {
        std::cerr << "tessera-edit: " << why << "\n";
        line.exit_code = 2;
        return line;
    };
    // Who asks for a command alone, as in "tessera-edit place --help", is told how it is written
    const std::string first = argc > 1 ? argv[1] : "";
    for (const CLI::App* command : app.get_subcommands({})) {
        if (command->get_name() != first) continue;
        const auto asks = [](std::string_view word) { return word == "-h" || word == "--help"; };
        if (!std::any_of(argv + 2, argv + argc, asks))
            return fail("URL and SCENE come first, as in tessera-edit http://127.0.0.1:7070 road " +
                        command->get_name() + "; see tessera-edit " + command->get_name() + " --help");
        std::cout << command->help("tessera-edit");
        return line;
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        line.exit_code = app.exit(error) == 0 ? 0 : 2;
        return line;
    }
    auto server = parse_server_address(url);
    if (!server) return fail(server.error().detail);
    options.server = std::move(*server);
    if (!token_file.empty()) {
        const auto token = text_of(token_file, 4096);
        if (!token) return fail("--token-file: " + token.error().detail);
        options.token = token->substr(0, token->find_first_of("\r\n"));
        if (options.token.empty()) return fail("--token-file " + token_file + ": its first line is empty");
    }
    if (const std::string wrong = commands.finish(); !wrong.empty()) return fail(wrong);
    options.edit.set_author(options.name);
    if (base_revision) options.edit.set_base_revision(*base_revision);
    options.patience = std::chrono::milliseconds{std::llround(patience * 1000)};
    line.go_on = true;
    return line;
}

}  // namespace tessera
