#include "server/prepare/commands.h"

#include <array>
#include <bit>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "server/prepare/content_numbers.h"
#include "server/prepare/photo_options.h"
#include "server/prepare/recorded.h"
#include "server/progress/interrupt.h"
#include "server/progress/terminal_progress.h"
#include "server/quality/report.h"
#include "server/scene/image_file.h"

namespace tessera {
namespace {

constexpr std::array channel_names{"normal", "roughness", "height"};

struct Arguments {
    std::string photo, asset, report, patch_map, drop, keep;
    std::array<std::string, channel_names.size()> channels;
    PrepareOptions options;
    std::int64_t max_megapixels = default_megapixels;
    bool go_on = false, quiet = false;
    bool given_options = false;  ///< Any option that only a preparation from the beginning takes.
};

Error invalid(std::string what) { return {ErrorCode::invalid_input, std::move(what)}; }

Result<std::vector<StandingChange>> standings_of(const Arguments& arguments) {
    std::vector<StandingChange> changes;
    for (const auto& [option, text, standing] :
         {std::tuple{"--drop", &arguments.drop, ExchangeAsset::Standing::dropped},
          std::tuple{"--keep", &arguments.keep, ExchangeAsset::Standing::pinned}}) {
        if (text->empty()) continue;
        const auto parsed = parse_contents(option, *text, standing);
        if (!parsed) return parsed.error();
        changes.insert(changes.end(), parsed->begin(), parsed->end());
    }
    return changes;
}

/// The aligned images that the command line names.
Result<std::vector<AlignedImage>> read_aligned(const Arguments& arguments) {
    std::vector<AlignedImage> aligned;
    for (std::size_t i = 0; i < channel_names.size(); ++i) {
        if (arguments.channels[i].empty()) continue;
        auto image = read_rgb_image(arguments.channels[i], photo_limits(arguments.max_megapixels));
        if (!image) return image.error();
        aligned.push_back({channel_names[i], std::move(*image)});
    }
    return aligned;
}

/// A hand-painted patch map is as large as the tile, and so tells its side.
Result<void> read_patch_map(const std::string& file, PrepareOptions& options) {
    auto map = read_label_image(file);
    if (!map) return map.error();
    const auto side = static_cast<std::uint32_t>(map->width);
    const std::string size = "is " + std::to_string(map->width) + "×" + std::to_string(map->height);
    if (map->width != map->height || !std::has_single_bit(side) || side < 16 || side > 4096)
        return invalid(file + ": " + size +
                       "; a patch map is square, its side a power of two from 16 to 4096");
    if (options.tile_side != 0 && options.tile_side != map->width)
        return invalid(file + ": " + size + ", but --tile is " + std::to_string(options.tile_side) +
                       "; leave --tile out, or paint the map as large");
    options.tile_side = map->width;
    options.patch_map = std::move(map->labels);
    return {};
}

/// What preparation goes on from, with what was said of its contents since, and the aligned images that it
/// needs.
Result<Earlier> read_continued(const Arguments& arguments, const Rgb8Image& photo,
                               const std::vector<StandingChange>& changes, bool has_aligned,
                               Progress& progress) {
    auto earlier = read_earlier(arguments.asset, photo);
    if (!earlier)
        return Error{earlier.error().code, earlier.error().detail + "; or leave --continue out, and " +
                                               arguments.photo + " is prepared afresh"};
    if (!earlier->cut_up.empty() && !has_aligned)
        return invalid(arguments.asset + ": holds its " + earlier->cut_up.front() +
                       " cut into tiles; name the image again: --" + earlier->cut_up.front() + " FILE");
    if (earlier->version != prepare_version)
        progress.note(arguments.asset + " was prepared by another version: what is not pinned may change");
    if (auto applied = apply_standings(earlier->asset, arguments.asset, changes); !applied)
        return applied.error();
    earlier->options.threads = arguments.options.threads;
    return earlier;
}

Result<ExchangeAsset> prepare_file(const Arguments& arguments, Progress& progress) {
    const auto changes = standings_of(arguments);
    if (!changes) return changes.error();
    if (auto free = check_asset_target(arguments.asset); !free) return free.error();
    const auto photo = read_rgb_image(arguments.photo, photo_limits(arguments.max_megapixels));
    if (!photo) return photo.error();
    auto aligned = read_aligned(arguments);
    if (!aligned) return aligned.error();

    PrepareOptions options = arguments.options;
    ExchangeAsset before;
    if (arguments.go_on) {
        auto earlier = read_continued(arguments, *photo, *changes, !aligned->empty(), progress);
        if (!earlier) return earlier.error();
        before = std::move(earlier->asset);
        options = std::move(earlier->options);
        if (aligned->empty()) *aligned = std::move(earlier->aligned);
    } else if (!arguments.patch_map.empty()) {
        if (auto read = read_patch_map(arguments.patch_map, options); !read) return read.error();
    }
    auto made = prepare_recorded(*photo, *aligned, options, arguments.go_on ? &before : nullptr, progress);
    if (!made) return Error{made.error().code, arguments.photo + ": " + made.error().detail};
    progress.advance("writing", 0);
    if (auto written = write_exchange_asset(arguments.asset, made->asset, made->preparation); !written)
        return written.error();
    progress.advance("writing", 1);
    return std::move(made->asset);
}

/// Without a photograph: what a person says of contents is written down, and nothing is searched.
Result<ExchangeAsset> edit_asset(const Arguments& arguments) {
    const auto changes = standings_of(arguments);
    if (!changes) return changes.error();
    if (auto changed = change_standings(arguments.asset, *changes); !changed) return changed.error();
    return read_exchange_asset(arguments.asset);
}

/// What options can be given together.
Result<void> check_combination(const Arguments& arguments) {
    const bool edits = !arguments.drop.empty() || !arguments.keep.empty();
    if (arguments.photo.empty() && (arguments.go_on || arguments.given_options || !edits))
        return invalid(std::string{"names no PHOTO; without one, only --drop and --keep change the asset"});
    if (!arguments.photo.empty() && edits && !arguments.go_on)
        return invalid("--drop and --keep change an asset that is there: leave PHOTO out, or add --continue");
    if (arguments.go_on && arguments.given_options)
        return invalid(
            "--continue goes on with what the asset was prepared with: leave the other options out, or "
            "leave --continue out to start afresh");
    if (!arguments.patch_map.empty() && arguments.options.method != ExchangeMethod::content_exchange)
        return invalid("--patch-map is for --method content_exchange: the other methods have none");
    return {};
}

void say(const Arguments& arguments, const ExchangeAsset& asset) {
    if (arguments.quiet) return;
    std::size_t contents = 0, dropped = 0;
    for (const auto& patch : asset.patches)
        for (const auto& content : patch.contents)
            ++(content.standing == ExchangeAsset::Standing::dropped ? dropped : contents);
    const std::string without = dropped > 0 ? " and " + std::to_string(dropped) + " dropped" : "";
    std::fprintf(stderr, "tessera prepare: %s: %s, tile of %d texels, %zu patches, %zu contents%s\n",
                 arguments.asset.c_str(), std::string{method_name(asset.method)}.c_str(), asset.tile_side,
                 asset.patches.size(), contents, without.c_str());
}

std::vector<TerminalProgress::Share> shares_of(const Arguments& arguments) {
    ExchangeMethod method = arguments.options.method;
    if (arguments.go_on)
        if (const auto made = read_preparation(arguments.asset)) method = made->method;
    const double preparing = arguments.photo.empty() ? 0.0 : arguments.report.empty() ? 0.95 : 0.7;
    std::vector<TerminalProgress::Share> shares;
    for (const auto& [stage, part] : prepare_shares(method)) shares.push_back({stage, preparing * part});
    shares.push_back({"writing", preparing / 19});
    if (!arguments.report.empty()) {
        shares.push_back({"measuring", (1 - preparing * 20 / 19) * 0.8});
        shares.push_back({"drawing", (1 - preparing * 20 / 19) * 0.2});
    }
    return shares;
}

int run_prepare(const Arguments& arguments) {
    const Interrupt interrupt;
    const auto done = [&]() -> Result<ExchangeAsset> {
        if (auto good = check_combination(arguments); !good) return good.error();
        if (!arguments.report.empty())
            if (auto free = check_report_target(arguments.report); !free) return free.error();
        TerminalProgress progress{"tessera prepare", shares_of(arguments), arguments.quiet,
                                  interrupt.token()};
        auto asset = arguments.photo.empty() ? edit_asset(arguments) : prepare_file(arguments, progress);
        if (asset && !arguments.report.empty())
            if (auto written = write_report(arguments.report, *asset, progress); !written)
                return written.error();
        return asset;
    }();
    if (!done) {
        std::fprintf(stderr, "tessera prepare: %s\n", done.error().detail.c_str());
        return 1;
    }
    say(arguments, *done);
    return 0;
}

int run_report(const Arguments& arguments) {
    const Interrupt interrupt;
    const auto done = [&]() -> Result<void> {
        if (auto free = check_report_target(arguments.report); !free) return free;
        TerminalProgress progress{
            "tessera report", {{"measuring", 0.8}, {"drawing", 0.2}}, arguments.quiet, interrupt.token()};
        const auto asset = read_exchange_asset(arguments.asset);
        if (!asset) return asset.error();
        return write_report(arguments.report, *asset, progress);
    }();
    if (done) return 0;
    std::fprintf(stderr, "tessera report: %s\n", done.error().detail.c_str());
    return 1;
}

/// What a preparation from the beginning takes; --continue takes all of it from the asset.
std::vector<CLI::Option*> add_search_options(CLI::App& command, Arguments& arguments) {
    PrepareOptions& options = arguments.options;
    constexpr const char* own = "the method's own, by the photograph's size";
    std::vector<CLI::Option*> added;
    added.push_back(add_method_option(command, options.method));
    added.push_back(command.add_option(
        "--tile", options.tile_side, "Side of the periodic tile in texels, a power of two from 16 to 4096"));
    added.push_back(
        command.add_option("--patches", options.patches,
                           "content_exchange: patches of the tile, about; interchange: in the library"));
    added.push_back(command.add_option("--contents", options.contents,
                                       "content_exchange: contents to find for each patch beside its own"));
    added.push_back(command.add_option("--colors", options.colors,
                                       "wang: colours of corners, 2 to 4: so many to the fourth tiles"));
    added.push_back(command.add_option("--blend", options.blend_texels,
                                       "Width of the blending along shapes in texels, even; 0 cuts hard"));
    for (std::size_t i = 1; i < added.size(); ++i) added[i]->default_str(own);
    added.push_back(
        command.add_option("--seed", options.seed, "Another seed, other patches")->capture_default_str());
    added.push_back(
        command.add_option("--patch-map", arguments.patch_map,
                           "content_exchange: a hand-painted patch map, a grey PNG of 8 or 16 bits as large "
                           "as the tile, one grey for each patch"));
    return added;
}

void add_prepare(CLI::App& app, int& exit_code) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App& command = *app.add_subcommand("prepare", "Makes of a photograph what an endless texture needs");
    command.add_option("PHOTO", arguments->photo,
                       "PNG, JPEG, WebP or TIFF; only --drop and --keep need none");
    command
        .add_option("-o,--output", arguments->asset, "Folder to write; an asset that is there is replaced")
        ->required();
    const auto search_options = add_search_options(command, *arguments);
    for (std::size_t i = 0; i < channel_names.size(); ++i)
        command.add_option(
            std::string{"--"} + channel_names[i], arguments->channels[i],
            "An image of the same surface, aligned with PHOTO texel by texel: shares its decisions");
    command.add_option(
        "--drop", arguments->drop,
        "Contents never to show, PATCH:CONTENT or PATCH, such as 3:7,5; numbered as in reports; a dropped "
        "patch of a group takes the group with it");
    command.add_option("--keep", arguments->keep,
                       "Contents to keep whenever preparation goes on; also undoes --drop");
    command.add_flag("--continue", arguments->go_on,
                     "Go on from the asset that is there: what is pinned stays, what is dropped is replaced");
    command.add_option("--report", arguments->report,
                       "An HTML file to judge the result by, and beside it the figures as JSON");
    add_megapixels_option(command, arguments->max_megapixels);
    command
        .add_option("--threads", arguments->options.threads,
                    "0: one for each processor; changes nothing but the time")
        ->capture_default_str();
    command.add_flag("-q,--quiet", arguments->quiet, "No progress, only errors");
    command.callback([arguments, search_options, &exit_code] {
        for (const CLI::Option* option : search_options) arguments->given_options |= option->count() > 0;
        exit_code = run_prepare(*arguments);
    });
}

void add_report(CLI::App& app, int& exit_code) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App& command = *app.add_subcommand("report", "Shows how good a prepared asset is");
    command.add_option("ASSET", arguments->asset, "The folder that `tessera prepare` made")->required();
    command
        .add_option("-o,--output", arguments->report,
                    "HTML file to write; the figures as JSON are put beside it")
        ->required();
    command.add_flag("-q,--quiet", arguments->quiet, "No progress, only errors");
    command.callback([arguments, &exit_code] { exit_code = run_report(*arguments); });
}

}  // namespace

void add_prepare_command(CLI::App& app, int& exit_code) {
    add_prepare(app, exit_code);
    add_report(app, exit_code);
}

}  // namespace tessera
