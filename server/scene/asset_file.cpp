#include "server/scene/asset_file.h"

#include <algorithm>
#include <set>

#include <unistd.h>

#include "proto/asset.pb.h"

#include "server/scene/image_file.h"
#include "server/scene/whole_file.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t max_asset_json_bytes = std::int64_t{1} << 26;
constexpr std::int32_t max_blend_texels = 64;
constexpr std::string_view prepared_by = "tessera " TESSERA_VERSION;

Error invalid(const fs::path& file, const std::string& what) {
    return {ErrorCode::invalid_input, file.string() + ": " + what};
}

/// The file that `field` names, which must stay inside the folder, also through symbolic links.
Result<fs::path> named_file(const fs::path& folder, const fs::path& json, std::string_view field,
                            const std::string& name, std::string_view unset) {
    const fs::path relative{name.empty() ? std::string{unset} : name};
    std::error_code failure;
    const fs::path root = fs::weakly_canonical(folder, failure);
    const fs::path target = failure ? fs::path{} : fs::weakly_canonical(folder / relative, failure);
    const auto [root_end, rest] = std::mismatch(root.begin(), root.end(), target.begin(), target.end());
    if (failure || relative.is_absolute() || root_end != root.end() || rest == target.end())
        return invalid(json, std::string{field} + ": \"" + relative.string() +
                                 "\" leaves the asset's folder; name a file inside it");
    return folder / relative;
}

/// One axis of a patch's or a content's place, as a small integer.
Result<std::int32_t> in_range(const fs::path& json, const std::string& field, std::uint32_t value,
                              std::int64_t least, std::int64_t most) {
    if (value < least || value > most)
        return invalid(json,
                       field + ": is " + std::to_string(value) + "; " +
                           (most < least ? "nothing fits there, since the exemplar is too small for the patch"
                                         : "from " + std::to_string(least) + " to " + std::to_string(most)) +
                           "; prepare the photograph again");
    return static_cast<std::int32_t>(value);
}

Result<ExchangeAsset::Patch> to_patch(const fs::path& json, const std::string& name,
                                             const proto::Patch& message, const ExchangeAsset& asset) {
    ExchangeAsset::Patch patch;
    const auto x = in_range(json, name + ".x", message.x(), 0, asset.tile_side - 1);
    const auto y = in_range(json, name + ".y", message.y(), 0, asset.tile_side - 1);
    const auto width = in_range(json, name + ".width", message.width(), 1, asset.tile_side / 2);
    const auto height = in_range(json, name + ".height", message.height(), 1, asset.tile_side / 2);
    for (const auto* side : {&x, &y, &width, &height})
        if (!*side) return side->error();
    patch.x = *x;
    patch.y = *y;
    patch.width = *width;
    patch.height = *height;

    if (message.contents_size() > ExchangeAsset::max_contents)
        return invalid(json, name + ".contents: has " + std::to_string(message.contents_size()) +
                                 "; at most " + std::to_string(ExchangeAsset::max_contents) +
                                 " for each patch");

    // The bounding box and half the blending width around it lie inside the exemplar
    const std::int32_t margin = asset.blend_texels / 2;
    for (int i = 0; i < message.contents_size(); ++i) {
        const std::string content = name + ".contents[" + std::to_string(i) + "]";
        const auto at_x = in_range(json, content + ".x", message.contents(i).x(), margin,
                                   asset.exemplar.width - patch.width - margin);
        if (!at_x) return at_x.error();
        const auto at_y = in_range(json, content + ".y", message.contents(i).y(), margin,
                                   asset.exemplar.height - patch.height - margin);
        if (!at_y) return at_y.error();
        patch.contents.push_back({{*at_x, *at_y}, {}});
    }
    return patch;
}

/// Every label names a patch, whose box encloses the texel; every patch has a texel.
Result<void> check_labels(const fs::path& json, const fs::path& labels_file,
                          const ExchangeAsset& asset) {
    std::vector<bool> seen(asset.patches.size());
    const std::int32_t mask = asset.tile_side - 1;
    for (std::int32_t y = 0, i = 0; y < asset.tile_side; ++y)
        for (std::int32_t x = 0; x < asset.tile_side; ++x, ++i) {
            const std::size_t label = asset.labels[static_cast<std::size_t>(i)];
            const std::string at = "texel (" + std::to_string(x) + ", " + std::to_string(y) + ")";
            if (label >= asset.patches.size())
                return invalid(labels_file, at + ": label " + std::to_string(label) +
                                                ", but patches_info has only " +
                                                std::to_string(asset.patches.size()) +
                                                " patches; prepare the photograph again");
            const auto& patch = asset.patches[label];
            if (((x - patch.x) & mask) >= patch.width || ((y - patch.y) & mask) >= patch.height)
                return invalid(json, "patches_info[" + std::to_string(label) + "]: its box does not hold " +
                                         at + " of " + labels_file.filename().string() +
                                         "; prepare the photograph again");
            seen[label] = true;
        }
    const auto unseen = std::find(seen.begin(), seen.end(), false);
    if (unseen != seen.end())
        return invalid(json, "patches_info[" + std::to_string(unseen - seen.begin()) + "]: no texel of " +
                                 labels_file.filename().string() +
                                 " has this label; prepare the photograph again");
    return {};
}

Result<void> check_square(const fs::path& file, std::int32_t width, std::int32_t height, std::int32_t side) {
    if (width != side || height != side)
        return invalid(file, "is " + std::to_string(width) + "×" + std::to_string(height) +
                                 ", but tile_side in asset.json is " + std::to_string(side));
    return {};
}

/// What the writer may replace: a folder that holds an asset and nothing else, or nothing at all.
Result<void> check_replaceable(const fs::path& folder) {
    static const std::set<std::string> ours{"asset.json", "exemplar.png", "tile.png", "patches.png"};
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

proto::ExchangeAsset to_message(const ExchangeAsset& asset, std::uint64_t seed) {
    proto::ExchangeAsset message;
    message.set_exemplar("exemplar.png");
    message.set_tile("tile.png");
    message.set_patches("patches.png");
    message.set_tile_side(static_cast<std::uint32_t>(asset.tile_side));
    message.set_blend_texels(static_cast<std::uint32_t>(asset.blend_texels));
    message.set_seed(seed);
    message.set_prepared_by(std::string{prepared_by});
    for (const auto& patch : asset.patches) {
        proto::Patch& out = *message.add_patches_info();
        out.set_x(static_cast<std::uint32_t>(patch.x));
        out.set_y(static_cast<std::uint32_t>(patch.y));
        out.set_width(static_cast<std::uint32_t>(patch.width));
        out.set_height(static_cast<std::uint32_t>(patch.height));
        for (const auto& [offset, shape, standing, corners] : patch.contents) {
            proto::Content& content = *out.add_contents();
            content.set_x(static_cast<std::uint32_t>(offset.x));
            content.set_y(static_cast<std::uint32_t>(offset.y));
        }
    }
    return message;
}

Result<void> write_parts(const fs::path& folder, const ExchangeAsset& asset, std::uint64_t seed) {
    if (auto done = write_rgb_png(folder / "exemplar.png", asset.exemplar); !done) return done;
    if (auto done = write_rgb_png(folder / "tile.png", asset.tile); !done) return done;
    if (auto done = write_label_png(folder / "patches.png", {asset.tile_side, asset.tile_side, asset.labels});
        !done)
        return done;
    const std::string json = write_json(to_message(asset, seed));
    if (auto done = write_whole_file(folder / "asset.json",
                                     {reinterpret_cast<const std::uint8_t*>(json.data()), json.size()});
        !done)
        return done;
    return sync_folder(folder);
}

}  // namespace

Result<ExchangeAsset> read_exchange_asset(const fs::path& folder) {
    const fs::path json = folder / "asset.json";
    const auto text = read_whole_file(json, max_asset_json_bytes);
    if (!text)
        return Error{text.error().code, text.error().detail + "; `tessera prepare PHOTO -o " +
                                            folder.string() + "` makes an asset"};
    proto::ExchangeAsset message;
    if (auto read = read_json(*text, json.string(), message); !read) return read.error();

    ExchangeAsset asset;
    const std::uint32_t side = message.tile_side();
    if (side < 16 || side > 4096 || (side & (side - 1)) != 0)
        return invalid(json, "tile_side: is " + std::to_string(side) + "; a power of two from 16 to 4096");
    asset.tile_side = static_cast<std::int32_t>(side);
    const std::uint32_t blend = message.blend_texels();
    if (blend > std::uint32_t{max_blend_texels} || blend % 2 != 0 || blend > side / 2)
        return invalid(json, "blend_texels: is " + std::to_string(blend) + "; even, from 0 to " +
                                 std::to_string(std::min<std::uint32_t>(max_blend_texels, side / 2)));
    asset.blend_texels = static_cast<std::int32_t>(blend);
    if (message.patches_info_size() < 1 || message.patches_info_size() > 65536)
        return invalid(json, "patches_info: has " + std::to_string(message.patches_info_size()) +
                                 " patches; from 1 to 65536");

    const auto exemplar_file = named_file(folder, json, "exemplar", message.exemplar(), "exemplar.png");
    const auto tile_file = named_file(folder, json, "tile", message.tile(), "tile.png");
    const auto labels_file = named_file(folder, json, "patches", message.patches(), "patches.png");
    for (const auto* file : {&exemplar_file, &tile_file, &labels_file})
        if (!*file) return file->error();
    auto exemplar = read_rgb_image(*exemplar_file);
    if (!exemplar) return exemplar.error();
    asset.exemplar = std::move(*exemplar);
    auto tile = read_rgb_image(*tile_file);
    if (!tile) return tile.error();
    if (auto fits = check_square(*tile_file, tile->width, tile->height, asset.tile_side); !fits)
        return fits.error();
    asset.tile = std::move(*tile);
    auto labels = read_label_image(*labels_file);
    if (!labels) return labels.error();
    if (auto fits = check_square(*labels_file, labels->width, labels->height, asset.tile_side); !fits)
        return fits.error();
    asset.labels = std::move(labels->labels);

    for (int i = 0; i < message.patches_info_size(); ++i) {
        auto patch =
            to_patch(json, "patches_info[" + std::to_string(i) + "]", message.patches_info(i), asset);
        if (!patch) return patch.error();
        asset.patches.push_back(std::move(*patch));
    }
    if (auto fits = check_labels(json, *labels_file, asset); !fits) return fits.error();
    return asset;
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
                                          std::uint64_t seed) {
    if (auto may = check_asset_target(target); !may) return may;
    const fs::path folder = without_slash(target);
    std::error_code failure;
    fs::path made = folder;
    made.replace_filename(std::string{"."} + folder.filename().string());
    made += ".partial-" + std::to_string(::getpid());
    fs::remove_all(made, failure);
    if (!fs::create_directory(made, failure))
        return Error{ErrorCode::io_failure, made.string() + ": " + failure.message()};
    Result<void> done = write_parts(made, asset, seed);
    if (done) done = move_into_place(made, folder);
    fs::remove_all(made, failure);
    if (done) done = sync_folder(folder.parent_path());
    return done;
}

}  // namespace tessera
