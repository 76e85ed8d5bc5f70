#include "server/prepare/recorded.h"

#include <algorithm>

#include "server/scene/asset_check.h"

namespace tessera {
namespace {

Rgb8Image cut(const Rgb8Image& image, const std::vector<PhotoPoint>& sources, std::int32_t width,
              std::int32_t height) {
    Rgb8Image out{width, height, {}};
    out.bytes.reserve(3 * sources.size());
    for (const PhotoPoint& from : sources) {
        const std::size_t at = 3 * (std::size_t(from.y) * std::size_t(image.width) + std::size_t(from.x));
        out.bytes.insert(out.bytes.end(), image.bytes.begin() + std::ptrdiff_t(at),
                         image.bytes.begin() + std::ptrdiff_t(at + 3));
    }
    return out;
}

std::string size_of(const Rgb8Image& image) {
    return std::to_string(image.width) + "×" + std::to_string(image.height);
}

}  // namespace

Result<RecordedAsset> prepare_recorded(const Rgb8Image& photo, const std::vector<AlignedImage>& aligned,
                                       const PrepareOptions& options, const ExchangeAsset* before,
                                       Progress& progress) {
    for (const AlignedImage& other : aligned)
        if (other.image.width != photo.width || other.image.height != photo.height)
            return Error{ErrorCode::invalid_input,
                         "is " + size_of(photo) + ", but --" + other.name + " is " + size_of(other.image) +
                             "; aligned images show the same surface texel by texel"};
    auto prepared = prepare_exchange(photo, options, before, progress);
    if (!prepared) return prepared.error();

    if (prepared->asset.patches.empty())
        return Error{ErrorCode::invalid_input,
                     "holds nothing that fits its tile; use a larger photograph or another --tile"};
    // What is written must load
    if (auto good = check_exchange_asset(
            prepared->asset, {"asset.json", "exemplar.png", "tile.png", "patches.png", "shapes.png"});
        !good)
        return good.error();
    RecordedAsset made;
    made.asset = std::move(prepared->asset);
    const ExchangeAsset& asset = made.asset;
    for (const AlignedImage& other : aligned) {
        Rgb8Image tile = cut(other.image, prepared->tile_sources, asset.tile_side, asset.tile_side);
        Rgb8Image exemplar =
            prepared->exemplar_sources.empty()
                ? other.image
                : cut(other.image, prepared->exemplar_sources, asset.exemplar.width, asset.exemplar.height);
        made.asset.channels.push_back({other.name, std::move(exemplar), std::move(tile)});
    }
    made.preparation = {.method = asset.method,
                        .version = prepare_version,
                        .photo = photo_id(photo),
                        .seed = options.seed,
                        .tile_side = options.tile_side,
                        .patches = options.patches,
                        .contents = options.contents,
                        .colors = options.colors,
                        .blend_texels = options.blend_texels,
                        .painted_patch_map = !options.patch_map.empty()};
    return made;
}

bool Earlier::is_judged() const {
    for (const auto& patch : asset.patches)
        for (const auto& content : patch.contents)
            if (content.standing != ExchangeAsset::Standing::chosen) return true;
    return false;
}

Result<Earlier> read_earlier(const std::filesystem::path& folder, const Rgb8Image& photo) {
    const auto made = read_preparation(folder);
    if (!made) return made.error();
    auto asset = read_exchange_asset(folder);
    if (!asset) return asset.error();
    const bool holds_photo = asset->method != ExchangeMethod::wang;
    // What the version before prepared does not name its photograph, but holds it
    if (made->photo.empty() ? !holds_photo || asset->exemplar.bytes != photo.bytes
                            : made->photo != photo_id(photo))
        return Error{ErrorCode::invalid_input,
                     folder.string() + ": was made of another photograph; name that one"};

    Earlier earlier;
    PrepareOptions& options = earlier.options;
    options.method = asset->method;
    options.tile_side = made->tile_side;
    options.patches = made->patches;
    options.contents = made->contents;
    options.colors = made->colors;
    options.blend_texels = made->blend_texels;
    options.seed = made->seed;
    if (made->painted_patch_map) options.patch_map = asset->labels;
    earlier.version = made->version;
    for (auto& channel : asset->channels)
        if (holds_photo)
            earlier.aligned.push_back({channel.name, std::move(channel.exemplar)});
        else
            earlier.cut_up.push_back(channel.name);
    earlier.asset = std::move(*asset);
    return earlier;
}

std::vector<TerminalProgress::Share> prepare_shares(ExchangeMethod method) {
    switch (method) {
        case ExchangeMethod::interchange:
            return {{"tile", 0.15}, {"patches", 0.25}, {"groups", 0.55}, {"sets", 0.05}};
        case ExchangeMethod::wang:
            return {{"tiles", 1.0}};
        case ExchangeMethod::content_exchange:
            break;
    }
    return {{"tile", 0.1}, {"patches", 0.05}, {"contents", 0.85}};
}

}  // namespace tessera
