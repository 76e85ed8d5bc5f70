#include <set>

#include <unistd.h>

#include "proto/asset.pb.h"

#include "server/files/whole_file.h"
#include "server/scene/asset_file.h"
#include "server/scene/digest.h"
#include "server/scene/image_file.h"
#include "server/scene/shape_sheet.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view prepared_by = "tessera " TESSERA_VERSION;

Error invalid(const fs::path& file, const std::string& what) {
    return {ErrorCode::invalid_input, file.string() + ": " + what};
}

/// What the writer may replace: a folder that holds an asset and nothing else, or nothing at all.
Result<void> check_replaceable(const fs::path& folder) {
    static const std::set<std::string> ours{"asset.json",      "exemplar.png",   "tile.png",
                                            "patches.png",     "shapes.png",     "normal.png",
                                            "normal-tile.png", "roughness.png",  "roughness-tile.png",
                                            "height.png",      "height-tile.png"};
    std::error_code failure;
    const auto status = fs::symlink_status(folder, failure);
    if (status.type() == fs::file_type::not_found) return {};
    if (!fs::is_directory(status))
        return invalid(folder, "exists and is not a folder; choose another place for the asset");
    std::size_t entries = 0;
    for (fs::directory_iterator entry{folder, failure}, end; !failure && entry != end;
         entry.increment(failure)) {
        ++entries;
        if (!ours.contains(entry->path().filename().string()) || !entry->is_regular_file())
            return invalid(folder, "exists and holds " + entry->path().filename().string() +
                                       ", which is no part of an asset; choose another place for the asset");
    }
    if (failure) return Error{ErrorCode::io_failure, folder.string() + ": " + failure.message()};
    if (entries > 0 && !fs::exists(folder / "asset.json"))
        return invalid(folder, "exists and holds no asset.json; choose another place for the asset");
    return {};
}

/// The folder's absolute path, which ends in its name.
fs::path without_slash(const fs::path& folder) {
    std::error_code failure;
    const fs::path absolute = fs::absolute(folder, failure).lexically_normal();
    return absolute.has_filename() ? absolute : absolute.parent_path();
}

proto::Method to_message(ExchangeMethod method) {
    switch (method) {
        case ExchangeMethod::interchange:
            return proto::Method::interchange;
        case ExchangeMethod::wang:
            return proto::Method::wang;
        case ExchangeMethod::content_exchange:
            break;
    }
    return proto::Method::content_exchange;
}

void describe(const Preparation& made, proto::Preparation& message) {
    message.set_version(made.version);
    message.set_photo(made.photo);
    message.set_tile_side(static_cast<std::uint32_t>(made.tile_side));
    message.set_patches(static_cast<std::uint32_t>(made.patches));
    message.set_contents(static_cast<std::uint32_t>(made.contents));
    message.set_colors(static_cast<std::uint32_t>(made.colors));
    if (made.blend_texels >= 0) message.set_blend_texels(static_cast<std::uint32_t>(made.blend_texels));
    message.set_painted_patch_map(made.painted_patch_map);
}

proto::ExchangeAsset to_message(const ExchangeAsset& asset, const ShapeSheet& shapes,
                                const Preparation& made) {
    proto::ExchangeAsset message;
    message.set_method(to_message(asset.method));
    message.set_exemplar("exemplar.png");
    message.set_tile("tile.png");
    if (!asset.labels.empty()) message.set_patches("patches.png");
    if (!shapes.places.empty()) message.set_shapes("shapes.png");
    message.set_tile_side(static_cast<std::uint32_t>(asset.tile_side));
    message.set_blend_texels(static_cast<std::uint32_t>(asset.blend_texels));
    message.set_seed(made.seed);
    message.set_prepared_by(std::string{prepared_by});
    describe(made, *message.mutable_preparation());
    std::size_t number = 0;
    for (const auto& patch : asset.patches) {
        proto::Patch& out = *message.add_patches_info();
        out.set_x(patch.x);
        out.set_y(patch.y);
        out.set_width(static_cast<std::uint32_t>(patch.width));
        out.set_height(static_cast<std::uint32_t>(patch.height));
        if (patch.set != ExchangeAsset::Set::none)
            out.set_set(patch.set == ExchangeAsset::Set::a ? "a" : "b");
        out.set_group(patch.group);
        for (const auto& content : patch.contents) {
            proto::Content& listed = *out.add_contents();
            listed.set_x(static_cast<std::uint32_t>(content.at.x));
            listed.set_y(static_cast<std::uint32_t>(content.at.y));
            if (!shapes.places.empty()) {
                listed.set_shape_x(static_cast<std::uint32_t>(shapes.places[number].x));
                listed.set_shape_y(static_cast<std::uint32_t>(shapes.places[number].y));
                ++number;
            }
            if (content.standing != ExchangeAsset::Standing::chosen)
                listed.set_standing(content.standing == ExchangeAsset::Standing::pinned ? "pinned"
                                                                                        : "dropped");
            if (asset.method == ExchangeMethod::wang) {
                std::string corners;
                for (int i = 0; i < 4; ++i)
                    corners += static_cast<char>('0' + (content.corners >> 2 * i & 3));
                listed.set_corners(corners);
            }
        }
    }
    for (const auto& channel : asset.channels) {
        proto::Channel& out = *message.add_channels();
        out.set_name(channel.name);
        out.set_exemplar(channel.name + ".png");
        out.set_tile(channel.name + "-tile.png");
    }
    return message;
}

Result<void> write_parts(const fs::path& folder, const ExchangeAsset& asset, const Preparation& preparation) {
    const auto shapes = pack_shapes(asset);
    if (!shapes) return invalid(folder, shapes.error().detail);
    if (auto done = write_rgb_png(folder / "exemplar.png", asset.exemplar); !done) return done;
    if (auto done = write_rgb_png(folder / "tile.png", asset.tile); !done) return done;
    if (!asset.labels.empty()) {
        const LabelImage labels{asset.tile_side, asset.tile_side, asset.labels};
        if (auto done = write_label_png(folder / "patches.png", labels); !done) return done;
    }
    if (!shapes->places.empty())
        if (auto done = write_bit_png(folder / "shapes.png", shapes->image); !done) return done;
    for (const auto& channel : asset.channels) {
        if (auto done = write_rgb_png(folder / (channel.name + ".png"), channel.exemplar); !done) return done;
        if (auto done = write_rgb_png(folder / (channel.name + "-tile.png"), channel.tile); !done)
            return done;
    }
    const std::string json = write_json(to_message(asset, *shapes, preparation));
    if (auto done = write_whole_file(folder / "asset.json",
                                     {reinterpret_cast<const std::uint8_t*>(json.data()), json.size()});
        !done)
        return done;
    return sync_folder(folder);
}

}  // namespace

std::string photo_id(const Rgb8Image& photo) {
    Digest digest;
    const std::string size = std::to_string(photo.width) + "x" + std::to_string(photo.height) + ":";
    digest.add(size.data(), size.size());
    digest.add(photo.bytes.data(), photo.bytes.size());
    return digest.hex();
}

Result<void> check_asset_target(const fs::path& target) {
    const fs::path folder = without_slash(target);
    if (auto may = check_replaceable(folder); !may) return may;
    std::error_code failure;
    if (!fs::is_directory(folder.parent_path(), failure))
        return Error{ErrorCode::io_failure,
                     folder.parent_path().string() + ": is not a folder; make it first"};
    return {};
}

Result<void> write_exchange_asset(const fs::path& target, const ExchangeAsset& asset,
                                  const Preparation& preparation) {
    if (auto may = check_asset_target(target); !may) return may;
    const fs::path folder = without_slash(target);
    fs::path unfinished = folder;
    unfinished.replace_filename(std::string{"."} + folder.filename().string());
    unfinished += ".partial-" + std::to_string(::getpid());
    const RemovedAtEnd made{unfinished};
    std::error_code failure;
    fs::remove_all(made.folder, failure);
    if (!fs::create_directory(made.folder, failure))
        return Error{ErrorCode::io_failure, made.folder.string() + ": " + failure.message()};
    if (auto done = write_parts(made.folder, asset, preparation); !done) return done;
    if (auto done = move_into_place(made.folder, folder); !done) return done;
    return sync_folder(folder.parent_path());
}

}  // namespace tessera
