#include <algorithm>
#include <atomic>
#include <string>
#include <thread>

#include "server/prepare/parallel.h"
#include "server/prepare/prepare.h"
#include "server/prepare/wang_tiles.h"

namespace tessera {
namespace {

constexpr std::int32_t most_tile_side = 4096;

Error invalid(std::string what) { return {ErrorCode::invalid_input, std::move(what)}; }

Result<PrepareOptions> checked(const Rgb8Image& photo, PrepareOptions options, Progress& progress) {
    const std::int32_t room = std::min(photo.width, photo.height);
    const std::string size = std::to_string(photo.width) + "×" + std::to_string(photo.height);
    if (room < least_wang_photo)
        return invalid("is " + size + " texels, too small for a tile; " + std::to_string(least_wang_photo) +
                       " a side are the least");
    const bool by_default = options.tile_side == 0;
    if (by_default) options.tile_side = room >= 1024 ? 256 : 128;
    if (options.colors == 0) options.colors = 2;
    if (options.threads == 0) options.threads = std::max(1u, std::thread::hardware_concurrency());
    if (options.tile_side < least_wang_side || options.tile_side > most_tile_side)
        return invalid("--tile is " + std::to_string(options.tile_side) + "; from " +
                       std::to_string(least_wang_side) + " to " + std::to_string(most_tile_side));
    if ((options.tile_side & (options.tile_side - 1)) != 0)
        return invalid("--tile is " + std::to_string(options.tile_side) +
                       "; a power of two, such as 128 or 256");
    if (options.colors < 2 || options.colors > 4)
        return invalid("--colors is " + std::to_string(options.colors) + "; from 2 to 4");
    if (options.blend_texels > 0)
        progress.note("tiles of corner colours continue each other as they are: nothing is blended");
    options.blend_texels = 0;

    // Tiles are chosen from half as much again
    const std::int32_t asked = options.tile_side;
    while (options.tile_side > least_wang_side && options.tile_side * 5 / 4 > room) options.tile_side /= 2;
    if (options.tile_side < asked && !by_default)
        progress.note("the photograph of " + size + " is too small for tiles of " + std::to_string(asked) +
                      ": they are " + std::to_string(options.tile_side));
    return options;
}

}  // namespace

Result<PreparedAsset> prepare_wang(const Rgb8Image& photo, const PrepareOptions& asked,
                                   const ExchangeAsset* before, Progress& progress) {
    const auto options = checked(photo, asked, progress);
    if (!options) return options.error();
    const PerceptualImage colors = to_perceptual(photo);
    const WangFrames frames{colors,        options->tile_side, options->colors,
                            options->seed, options->threads,   progress};

    // The tiles side by side, one square of the atlas for each
    const std::int32_t side = options->tile_side, columns = options->colors * options->colors;
    const std::int32_t atlas_side = columns * side;
    const auto tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(columns);
    PreparedAsset made;
    made.exemplar_sources.resize(tiles * static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    std::atomic<std::size_t> done{0};
    for_each_index(tiles, options->threads, [&](std::size_t tile) {
        if (progress.stop().stop_requested()) return;
        const std::vector<PhotoPoint> sources =
            frames.make_tile(wang_corners(static_cast<std::int32_t>(tile), options->colors));
        const std::int32_t left = static_cast<std::int32_t>(tile) % columns * side;
        const std::int32_t top = static_cast<std::int32_t>(tile) / columns * side;
        for (std::int32_t y = 0; y < side; ++y)
            std::copy_n(sources.begin() + std::ptrdiff_t{y} * side, side,
                        made.exemplar_sources.begin() + std::ptrdiff_t{top + y} * atlas_side + left);
        progress.advance("tiles", static_cast<double>(++done) / static_cast<double>(tiles));
    });
    if (progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "the preparation was stopped"};

    ExchangeAsset& asset = made.asset;
    asset.method = ExchangeMethod::wang;
    asset.tile_side = side;
    asset.exemplar = {atlas_side, atlas_side, {}};
    for (const PhotoPoint from : made.exemplar_sources) {
        const auto at = 3 * (std::ptrdiff_t{from.y} * photo.width + from.x);
        asset.exemplar.bytes.insert(asset.exemplar.bytes.end(), photo.bytes.begin() + at,
                                    photo.bytes.begin() + at + 3);
    }
    asset.tile = {side, side, {}};
    for (std::int32_t y = 0; y < side; ++y) {
        const auto row = std::ptrdiff_t{y} * atlas_side;
        asset.tile.bytes.insert(asset.tile.bytes.end(), asset.exemplar.bytes.begin() + 3 * row,
                                asset.exemplar.bytes.begin() + 3 * (row + side));
        made.tile_sources.insert(made.tile_sources.end(), made.exemplar_sources.begin() + row,
                                 made.exemplar_sources.begin() + row + side);
    }
    ExchangeAsset::Patch square{0, 0, side, side, {}, ExchangeAsset::Set::none};
    BitMask whole{side, side};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x) whole.set(x, y);
    for (std::int32_t tile = 1; tile < static_cast<std::int32_t>(tiles); ++tile)
        square.contents.push_back({{tile % columns * side, tile / columns * side},
                                   whole,
                                   ExchangeAsset::Standing::chosen,
                                   wang_corners(tile, options->colors)});
    if (before != nullptr && before->method == ExchangeMethod::wang && before->patches.size() == 1)
        for (auto& content : square.contents)
            for (const auto& earlier : before->patches[0].contents)
                if (earlier.corners == content.corners) content.standing = earlier.standing;
    asset.patches.push_back(std::move(square));
    return made;
}

}  // namespace tessera
