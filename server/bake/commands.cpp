#include "server/bake/commands.h"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include <CLI/CLI.hpp>

#include "server/bake/bake.h"
#include "server/pages/evaluate_within.h"
#include "server/pages/page_encoder.h"
#include "server/progress/interrupt.h"
#include "server/progress/terminal_progress.h"
#include "server/scene/scene.h"
#include "shared/page/parameter.h"

namespace tessera {
namespace {

struct Arguments {
    std::string scene;
    std::string output;
    std::string region;
    std::string accuracy = "exact";
    std::string max_error;
    std::string channels{name_of(ChannelSet::albedo)};
    std::uint32_t level = 0, x = 0, y = 0;
    std::int32_t gutter = 0;
    std::int64_t slice = 0, step = 0;
    double parameter = 0;
    bool quiet = false;
};

Result<void> write_file(const std::string& file, const std::vector<std::uint8_t>& bytes) {
    const std::string partial = file + ".partial";
    std::ofstream out{partial, std::ios::binary | std::ios::trunc};
    out.write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
    out.close();
    std::error_code failure;
    if (out) std::filesystem::rename(partial, file, failure);
    if (out && !failure) return {};
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    return Error{ErrorCode::io_failure, file + ": cannot be written"};
}

/// The texture of the channel set asked for.
Result<const Texture*> texture_of(const Scene& scene, const std::string& channels) {
    const auto set = channel_set_named(channels);
    if (const Texture* const texture = set ? scene.texture_of(*set) : nullptr) return texture;
    return Error{ErrorCode::invalid_input,
                 "--channels: the scene has no \"" + channels + "\"; it has " + scene.channel_names()};
}

Result<std::optional<ErrorLimit>> limit_of(const Arguments& arguments) {
    if (arguments.max_error.empty()) return std::optional<ErrorLimit>{};
    if (const auto limit = error_limit_named(arguments.max_error)) return limit;
    return Error{ErrorCode::invalid_input,
                 "--max-error: \"" + arguments.max_error +
                     "\" is not a number of 8-bit codes from 0 to 255, such as 0.5"};
}

/// The file is there, and yet not what was asked for.
Error beyond_limit(const Arguments& arguments, double bound_codes) {
    char bound[32];
    std::snprintf(bound, sizeof bound, "%.4f", bound_codes);
    return {ErrorCode::invalid_input, arguments.output + ": written, but its bound is " + bound +
                                          " codes even at --accuracy exact, more than --max-error " +
                                          arguments.max_error};
}

/// Sets what of slice, step and parameter the scene has. Error: one was asked for that it has not.
Result<void> place(const Scene& scene, const Arguments& arguments, TexelRegion& region) {
    const auto refuse = [](const char* what) { return Error{ErrorCode::invalid_input, what}; };
    if (arguments.slice != 0 && scene.slices == 1)
        return refuse("--slice: the scene is flat, it has no slices; leave it out");
    if (arguments.step != 0 && !scene.animated)
        return refuse("--step: nothing moves in the scene; leave it out");
    if (arguments.parameter != 0 && scene.parameters.empty())
        return refuse("--parameter: nothing in the scene looks at it; leave it out");
    region.slice = scene.same_slice(arguments.slice);
    region.step = scene.same_step(arguments.step);
    region.parameter = scene.same_parameter(static_cast<std::int32_t>(arguments.parameter * parameter_one));
    return {};
}

std::string validity_text(const Validity& valid) {
    if (valid.is_static()) return ", the same at every step";
    return ", the same from step " +
           (valid.from == always ? std::string{"ever"} : std::to_string(valid.from)) + " to before " +
           (valid.until == never ? std::string{"never"} : std::to_string(valid.until));
}

/// "bound 0.0000 codes"; where it is not certain, how likely it holds.
std::string bound_text(double codes, double confidence) {
    char text[80];
    std::snprintf(text, sizeof text, "bound %.4f codes", codes);
    std::string told = text;
    if (confidence < 1) {
        std::snprintf(text, sizeof text, " with probability %.12g", confidence);
        told += text;
    }
    return told;
}

Result<void> run_page(const Arguments& arguments) {
    const auto dot = arguments.output.rfind('.');
    const auto format =
        page_format(dot == std::string::npos ? "" : std::string_view{arguments.output}.substr(dot + 1));
    if (!format)
        return Error{ErrorCode::invalid_input, arguments.output + ": end it in .png, .jpg, .webp or .rgba"};
    const auto limit = limit_of(arguments);
    if (!limit) return limit.error();
    const auto scene = load_scene(arguments.scene);
    if (!scene) return scene.error();
    const Extent extent = (*scene)->extent;
    if (arguments.level > extent.n ||
        !extent.contains({static_cast<std::uint8_t>(arguments.level), arguments.x, arguments.y}))
        return Error{
            ErrorCode::no_such_page,
            arguments.level > extent.n
                ? "LEVEL is 0 to " + std::to_string(extent.n) + " in this scene"
                : "X and Y are 0 to " +
                      std::to_string(extent.side_pages(static_cast<std::uint8_t>(arguments.level)) - 1) +
                      " on level " + std::to_string(arguments.level)};
    const PageKey page{static_cast<std::uint8_t>(arguments.level), arguments.x, arguments.y};
    const auto texture = texture_of(**scene, arguments.channels);
    if (!texture) return texture.error();
    TexelRegion region = region_of(page, arguments.gutter);
    if (auto placed = place(**scene, arguments, region); !placed) return placed;
    Rgba8Image texels;
    const auto evaluated = evaluate_within(**texture, region, *limit,
                                           Budget{.accuracy = *accuracy_named(arguments.accuracy)}, texels);
    if (!evaluated) return evaluated.error();
    const Evaluation& evaluation = evaluated->evaluation;
    const auto bytes = encode_page(texels, *format, (*texture)->texel_kind());
    if (!bytes) return bytes.error();
    if (auto written = write_file(arguments.output, *bytes); !written) return written;
    if (!arguments.quiet)
        std::fprintf(stderr, "%s: level %u page (%u, %u), method %.*s, %s%s\n", arguments.output.c_str(),
                     arguments.level, arguments.x, arguments.y, static_cast<int>(evaluation.method.size()),
                     evaluation.method.data(),
                     bound_text(evaluation.bound_codes, evaluation.confidence).c_str(),
                     (*scene)->animated ? validity_text(evaluation.validity).c_str() : "");
    if (!evaluated->met) return beyond_limit(arguments, evaluation.bound_codes);
    return {};
}

/// "X,Y,W,H"
Result<TexelRegion> parse_region(const std::string& text, std::uint32_t level) {
    std::int64_t numbers[4] = {};
    const char* at = text.data();
    const char* const end = text.data() + text.size();
    for (std::size_t i = 0; i < 4; ++i) {
        const auto [next, failure] = std::from_chars(at, end, numbers[i]);
        const bool separated = i == 3 ? next == end : next != end && *next == ',';
        if (failure != std::errc{} || !separated)
            return Error{
                ErrorCode::invalid_input,
                "--region: \"" + text + "\" is not X,Y,W,H in texels of the level, such as 0,0,2048,2048"};
        at = next + 1;
    }
    constexpr std::int64_t farthest = std::int64_t{1} << 40;
    for (std::size_t i = 0; i < 4; ++i)
        if (numbers[i] < (i < 2 ? -farthest : 1) || numbers[i] > (i < 2 ? farthest : max_bake_side))
            return Error{ErrorCode::invalid_input,
                         "--region: X and Y are within ±2^40, W and H 1 to " + std::to_string(max_bake_side)};
    if (level > max_level) return Error{ErrorCode::invalid_input, "--level: 0 to 30"};
    return TexelRegion{static_cast<std::uint8_t>(level), numbers[0], numbers[1],
                       static_cast<std::int32_t>(numbers[2]), static_cast<std::int32_t>(numbers[3])};
}

Result<void> run_bake(const Arguments& arguments) {
    auto region = parse_region(arguments.region, arguments.level);
    if (!region) return region.error();
    const auto limit = limit_of(arguments);
    if (!limit) return limit.error();
    const auto scene = load_scene(arguments.scene);
    if (!scene) return scene.error();
    if (auto placed = place(**scene, arguments, *region); !placed) return placed;
    const auto texture = texture_of(**scene, arguments.channels);
    if (!texture) return texture.error();
    const Interrupt interrupt;
    TerminalProgress progress{"tessera bake", {{"baking", 1.0}}, arguments.quiet, interrupt.token()};
    const auto baked =
        bake(**texture, *region, *limit,
             Budget{.accuracy = *accuracy_named(arguments.accuracy), .cancelled = interrupt.token()},
             arguments.output, [&](double done) { progress.advance("baking", done); });
    if (!baked && baked.error().code == ErrorCode::cancelled)
        return Error{ErrorCode::cancelled,
                     arguments.output + ": stopped before it was done; nothing is left of it"};
    if (baked && !arguments.quiet)
        progress.note(arguments.output + ": " + std::to_string(region->width) + " × " +
                      std::to_string(region->height) + " texels of level " + std::to_string(region->level) +
                      ", " + bound_text(baked->bound_codes, baked->confidence));
    if (!baked) return baked.error();
    if (!baked->within_limit) return beyond_limit(arguments, baked->bound_codes);
    return {};
}

Result<void> run_check(const Arguments& arguments) {
    const auto scene = load_scene(arguments.scene);
    if (!scene) return scene.error();
    const Scene& s = **scene;
    std::printf("%s: %s\n", s.id.c_str(), s.title.c_str());
    std::printf("extent: %lld texels a side, levels 0 to %d, fingerprint %s\n",
                static_cast<long long>(s.extent.side_texels()), int{s.extent.n}, s.fingerprint.c_str());
    if (s.slices > 1)
        std::printf("slices: 0 to %d, which repeat\n", s.slices - 1);
    else if (s.slices == 0)
        std::printf("slices: without end\n");
    if (s.animated) {
        std::printf("animated: %g steps a second", s.steps_per_second);
        if (s.loop_steps > 0) std::printf(", again from step %lld on", static_cast<long long>(s.loop_steps));
        std::printf("\n");
    }
    if (!s.block_list.empty()) std::printf("blocks:\n%s", s.block_list.c_str());
    std::string plan = s.texture->description();
    if (!plan.ends_with('\n')) plan += '\n';
    std::printf("%s", plan.c_str());
    std::size_t bytes = s.texture->memory_bytes();
    for (const Channels& channels : s.channels) {
        std::printf("%s\n", channels.texture->description().c_str());
        bytes += channels.texture->memory_bytes();
    }
    std::printf("channels: %s\n", s.channel_names().c_str());
    std::printf("memory: %.1f MiB\n", double(bytes) / (1 << 20));
    return {};
}

void report(std::string_view command, const Result<void>& result, int& exit_code) {
    exit_code = result ? 0 : 1;
    if (!result)
        std::fprintf(stderr, "tessera %.*s: %s\n", static_cast<int>(command.size()), command.data(),
                     result.error().detail.c_str());
}

void add_common(CLI::App& command, Arguments& arguments) {
    command.add_option("SCENE", arguments.scene, "Folder of a scene, with its scene.json")->required();
}

void add_output(CLI::App& command, Arguments& arguments, const char* help) {
    command.add_option("-o,--output", arguments.output, help)->required();
    CLI::Option* const accuracy =
        command.add_option("--accuracy", arguments.accuracy, "How much error is allowed")
            ->check(CLI::IsMember({"exact", "high", "fast"}))
            ->capture_default_str();
    command
        .add_option(
            "--max-error", arguments.max_error,
            "How much error is allowed, in 8-bit codes of linear light: takes the cheapest accuracy whose "
            "bound keeps it; where none does, the exit code is 1")
        ->excludes(accuracy);
    command
        .add_option("--channels", arguments.channels,
                    "What to show of the surface: albedo, normal, roughness, height or moments")
        ->capture_default_str();
    command
        .add_option("--slice", arguments.slice,
                    "Slice of a texture with a third dimension, in texels of level 0")
        ->check(CLI::Range(-max_slice, max_slice))
        ->capture_default_str();
    command.add_option("--step", arguments.step, "Step of the animation clock, where the scene moves")
        ->check(CLI::Range(-max_step, max_step))
        ->capture_default_str();
    command
        .add_option("--parameter", arguments.parameter,
                    "What requests tell animations, 0 to 1, where the scene has such")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command.add_flag("-q,--quiet", arguments.quiet, "Say nothing but errors");
}

}  // namespace

void add_bake_commands(CLI::App& app, int& exit_code) {
    const auto arguments = std::make_shared<Arguments>();

    CLI::App& page = *app.add_subcommand("page", "Writes one page of a scene to a file");
    add_common(page, *arguments);
    page.add_option("LEVEL", arguments->level, "MIP level, 0 is the finest")->required();
    page.add_option("X", arguments->x, "Column of the page on its level")->required();
    page.add_option("Y", arguments->y, "Row of the page on its level")->required();
    page.add_option("--gutter", arguments->gutter, "Texels more on each side")
        ->check(CLI::Range(0, max_gutter_texels))
        ->capture_default_str();
    add_output(page, *arguments, "File to write: .png, .jpg, .webp or .rgba");
    page.callback([arguments, &exit_code] { report("page", run_page(*arguments), exit_code); });

    CLI::App& bake_command =
        *app.add_subcommand("bake", "Writes a region of a scene to an image file, however large");
    add_common(bake_command, *arguments);
    bake_command.add_option("--level", arguments->level, "MIP level, 0 is the finest")->capture_default_str();
    bake_command.add_option("--region", arguments->region, "X,Y,W,H in texels of the level")->required();
    add_output(bake_command, *arguments,
               "File to write: .png, .exr (linear half floats) or .tx (MIP-mapped)");
    bake_command.callback([arguments, &exit_code] { report("bake", run_bake(*arguments), exit_code); });

    CLI::App& check = *app.add_subcommand("check", "Checks a scene; prints its plan and the memory it takes");
    add_common(check, *arguments);
    check.callback([arguments, &exit_code] { report("check", run_check(*arguments), exit_code); });
}

}  // namespace tessera
