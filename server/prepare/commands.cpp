#include "server/prepare/commands.h"

#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "server/prepare/prepare.h"
#include "server/progress/interrupt.h"
#include "server/progress/terminal_progress.h"
#include "server/scene/asset_file.h"
#include "server/scene/image_file.h"

namespace tessera {
namespace {

struct Arguments {
    std::string photo;
    std::string asset;
    PrepareOptions options;
    bool quiet = false;
};

Result<ExchangeAsset> prepare_file(const Arguments& arguments, Progress& progress) {
    if (auto free = check_asset_target(arguments.asset); !free) return free.error();
    const auto photo = read_rgb_image(arguments.photo);
    if (!photo) return photo.error();
    auto prepared = prepare_exchange(*photo, arguments.options, nullptr, progress);
    if (!prepared) return Error{prepared.error().code, arguments.photo + ": " + prepared.error().detail};
    progress.advance("writing", 0);
    auto written = write_exchange_asset(arguments.asset, prepared->asset, arguments.options.seed);
    if (!written) return written.error();
    return std::move(prepared->asset);
}

int run(const Arguments& arguments) {
    const Interrupt interrupt;
    Result<ExchangeAsset> asset = [&] {
        TerminalProgress progress{"tessera prepare",
                                  {{"tile", 0.1}, {"patches", 0.05}, {"contents", 0.8}, {"writing", 0.05}},
                                  arguments.quiet,
                                  interrupt.token()};
        return prepare_file(arguments, progress);
    }();
    if (!asset) {
        std::fprintf(stderr, "tessera prepare: %s\n", asset.error().detail.c_str());
        return 1;
    }
    std::size_t contents = 0;
    for (const auto& patch : asset->patches) contents += patch.contents.size();
    if (!arguments.quiet)
        std::fprintf(stderr, "tessera prepare: %s: tile of %d texels, %zu patches, %zu contents\n",
                     arguments.asset.c_str(), asset->tile_side, asset->patches.size(), contents);
    return 0;
}

}  // namespace

void add_prepare_command(CLI::App& app, int& exit_code) {
    const auto arguments = std::make_shared<Arguments>();
    PrepareOptions& options = arguments->options;
    CLI::App& command = *app.add_subcommand("prepare", "Makes of a photograph what an endless texture needs");
    command.add_option("PHOTO", arguments->photo, "PNG, JPEG, WebP or TIFF")->required();
    command
        .add_option("-o,--output", arguments->asset, "Folder to write; an asset that is there is replaced")
        ->required();
    command.add_option("--tile", options.tile_side, "Side of the periodic tile in texels, a power of two")
        ->capture_default_str();
    command.add_option("--patches", options.patches, "Patches of the tile, about")->capture_default_str();
    command.add_option("--contents", options.contents, "Contents to find for each patch")
        ->capture_default_str();
    command
        .add_option("--blend", options.blend_texels, "Width of the blending between patches in texels, even")
        ->capture_default_str();
    command.add_option("--seed", options.seed, "Another seed, other patches")->capture_default_str();
    command
        .add_option("--threads", options.threads, "0: one for each processor; changes nothing but the time")
        ->capture_default_str();
    command.add_flag("-q,--quiet", arguments->quiet, "No progress, only errors");
    command.callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace tessera
