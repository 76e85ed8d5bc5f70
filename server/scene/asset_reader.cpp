#include <algorithm>
#include <optional>
#include <set>

#include "proto/asset.pb.h"

#include "server/files/whole_file.h"
#include "server/scene/asset_check.h"
#include "server/scene/asset_file.h"
#include "server/scene/image_file.h"
#include "server/scene/shape_sheet.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::int32_t max_blend_texels = 64;
constexpr int max_patches = 65535, max_contents_in_all = 65535;
constexpr const char* again = "; prepare the photograph again";

/// A photograph of the largest size that preparation takes, or all tiles of four corner colours.
constexpr ImageLimits exemplar_limits{.max_texels = std::int64_t{1} << 27, .max_side = 65536};
constexpr ImageLimits shapes_limits{.max_texels = max_sheet_texels, .max_side = max_sheet_side};

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

/// One number of a patch or a content, as a small integer.
Result<std::int32_t> in_range(const fs::path& json, const std::string& field, std::int64_t value,
                              std::int64_t least, std::int64_t most, const char* too_small = "the exemplar") {
    if (value < least || value > most)
        return invalid(json,
                       field + ": is " + std::to_string(value) + "; " +
                           (most < least ? "nothing fits there, since " + std::string{too_small} +
                                               " is too small for the patch"
                                         : "from " + std::to_string(least) + " to " + std::to_string(most)) +
                           again);
    return static_cast<std::int32_t>(value);
}

/// Takes the value or returns the error: `target` is set unless it is out of range.
Result<void> set_in_range(std::int32_t& target, const Result<std::int32_t>& value) {
    if (!value) return value.error();
    target = *value;
    return {};
}

Result<void> check_image_size(const fs::path& file, const Rgb8Image& image, std::int32_t width,
                              std::int32_t height, const std::string& whose) {
    if (image.width == width && image.height == height) return {};
    return invalid(
        file,
        "is " + std::to_string(image.width) + "×" + std::to_string(image.height) + ", but " + whose + " " +
            (width == height ? std::to_string(width) : std::to_string(width) + "×" + std::to_string(height)));
}

std::optional<ExchangeMethod> method_of(const proto::ExchangeAsset& message) {
    switch (message.method()) {
        case proto::Method::content_exchange:
            return ExchangeMethod::content_exchange;
        case proto::Method::interchange:
            return ExchangeMethod::interchange;
        case proto::Method::wang:
            return ExchangeMethod::wang;
        default:
            return std::nullopt;
    }
}

/// Reads one asset from its folder, step by step; what is read already is what the next step is held against.
class AssetReader {
  public:
    explicit AssetReader(const fs::path& folder) : folder_{folder} { files_.json = folder / "asset.json"; }

    Result<proto::ExchangeAsset> read_message() const {
        const auto text = read_whole_file(files_.json, max_asset_json_bytes);
        if (!text)
            return Error{text.error().code, text.error().detail + "; `tessera prepare PHOTO -o " +
                                                folder_.string() + "` makes an asset"};
        proto::ExchangeAsset message;
        if (auto read = read_json(*text, files_.json.string(), message); !read) return read.error();
        return message;
    }

    Result<ExchangeAsset> read() {
        auto message = read_message();
        if (!message) return message.error();
        message_ = std::move(*message);
        for (const auto step :
             {&AssetReader::take_numbers, &AssetReader::find_files, &AssetReader::read_images,
              &AssetReader::read_patches, &AssetReader::read_shapes, &AssetReader::read_channels})
            if (auto taken = (this->*step)(); !taken) return taken.error();
        if (auto good = check_exchange_asset(asset_, files_); !good) return good.error();
        return std::move(asset_);
    }

  private:
    bool is_interchange() const { return asset_.method == ExchangeMethod::interchange; }
    Error invalid_field(const std::string& what) const { return invalid(files_.json, what); }

    Result<void> take_numbers() {
        const auto method = method_of(message_);
        if (!method) return invalid_field("method: \"content_exchange\", \"interchange\" or \"wang\"");
        asset_.method = *method;
        const std::uint32_t side = message_.tile_side();
        if (side < 16 || side > 4096 || (side & (side - 1)) != 0)
            return invalid_field("tile_side: is " + std::to_string(side) +
                                 "; a power of two from 16 to 4096");
        asset_.tile_side = static_cast<std::int32_t>(side);
        const std::uint32_t blend = message_.blend_texels();
        if (blend > std::uint32_t{max_blend_texels} || blend % 2 != 0 || blend > side / 2)
            return invalid_field("blend_texels: is " + std::to_string(blend) + "; even, from 0 to " +
                                 std::to_string(std::min<std::uint32_t>(max_blend_texels, side / 2)));
        asset_.blend_texels = static_cast<std::int32_t>(blend);

        const int patches = message_.patches_info_size();
        const bool is_wang = asset_.method == ExchangeMethod::wang;
        if (patches < 1 || patches > max_patches || (is_wang && patches > 1))
            return invalid_field(
                "patches_info: has " + std::to_string(patches) + " patches; " +
                (is_wang ? "one, the square tile" : "from 1 to " + std::to_string(max_patches)));
        int contents = 0;
        for (const auto& patch : message_.patches_info()) contents += patch.contents_size();
        if (contents > max_contents_in_all)
            return invalid_field("patches_info: has " + std::to_string(contents) +
                                 " contents in all; at most " + std::to_string(max_contents_in_all));
        return {};
    }

    Result<void> find_files() {
        const auto find = [&](fs::path& file, const char* field, const std::string& name,
                              const char* unset) -> Result<void> {
            auto found = named_file(folder_, files_.json, field, name, unset);
            if (!found) return found.error();
            file = std::move(*found);
            return {};
        };
        if (auto found = find(files_.exemplar, "exemplar", message_.exemplar(), "exemplar.png"); !found)
            return found;
        if (auto found = find(files_.tile, "tile", message_.tile(), "tile.png"); !found) return found;
        if (asset_.method == ExchangeMethod::content_exchange) {
            if (auto found = find(files_.patches, "patches", message_.patches(), "patches.png"); !found)
                return found;
        } else if (!message_.patches().empty()) {
            return invalid_field("patches: only content_exchange has a patch map; leave it out");
        }
        if (message_.shapes().empty()) return {};
        return find(files_.shapes, "shapes", message_.shapes(), "");
    }

    Result<void> read_images() {
        auto exemplar = read_rgb_image(files_.exemplar, exemplar_limits);
        if (!exemplar) return exemplar.error();
        asset_.exemplar = std::move(*exemplar);
        auto tile = read_rgb_image(files_.tile);
        if (!tile) return tile.error();
        const std::string whose = "tile_side in asset.json is";
        const std::int32_t side = asset_.tile_side;
        if (auto fits = check_image_size(files_.tile, *tile, side, side, whose); !fits) return fits;
        asset_.tile = std::move(*tile);
        if (files_.patches.empty()) return {};
        auto labels = read_label_image(files_.patches);
        if (!labels) return labels.error();
        if (auto fits =
                check_image_size(files_.patches, {labels->width, labels->height, {}}, side, side, whose);
            !fits)
            return fits;
        asset_.labels = std::move(labels->labels);
        return {};
    }

    Result<void> read_patches() {
        for (int p = 0; p < message_.patches_info_size(); ++p) {
            const std::string name = "patches_info[" + std::to_string(p) + "]";
            auto patch = read_box(name, message_.patches_info(p));
            if (!patch) return patch.error();
            const auto& contents = message_.patches_info(p).contents();
            for (int c = 0; c < contents.size(); ++c) {
                auto content =
                    read_content(name + ".contents[" + std::to_string(c) + "]", contents[c], *patch);
                if (!content) return content.error();
                patch->contents.push_back(std::move(*content));
            }
            asset_.patches.push_back(std::move(*patch));
        }
        return {};
    }

    Result<ExchangeAsset::Patch> read_box(const std::string& name, const proto::Patch& message) const {
        // First texel and largest side, by method
        const std::int64_t side = asset_.tile_side;
        std::int64_t first = 0, last = side - 1, largest = side / 2;
        int fewest = 0, most = ExchangeAsset::max_contents;
        if (is_interchange())
            first = -side / 2, last = side + side / 2 - 1, largest = 2 * side, fewest = most = 1;
        if (message.group() != 0) last = 8 * side - 1;
        if (asset_.method == ExchangeMethod::wang) last = 0, largest = side;
        const std::int64_t smallest = asset_.method == ExchangeMethod::wang ? side : 1;

        ExchangeAsset::Patch patch;
        const auto& json = files_.json;
        if (auto set = set_in_range(patch.x, in_range(json, name + ".x", message.x(), first, last)); !set)
            return set.error();
        if (auto set = set_in_range(patch.y, in_range(json, name + ".y", message.y(), first, last)); !set)
            return set.error();
        if (auto set = set_in_range(patch.width,
                                    in_range(json, name + ".width", message.width(), smallest, largest));
            !set)
            return set.error();
        if (auto set = set_in_range(patch.height,
                                    in_range(json, name + ".height", message.height(), smallest, largest));
            !set)
            return set.error();

        const int contents = message.contents_size();
        if (contents < fewest || contents > most)
            return invalid_field(name + ".contents: has " + std::to_string(contents) + "; " +
                                 (fewest == most ? "exactly one for each patch of interchange"
                                                 : "at most " + std::to_string(most) + " for each patch"));
        if (message.set() == "a" || message.set() == "b")
            patch.set = message.set() == "a" ? ExchangeAsset::Set::a : ExchangeAsset::Set::b;
        if ((!message.set().empty() && patch.set == ExchangeAsset::Set::none) ||
            (patch.set != ExchangeAsset::Set::none && !is_interchange()))
            return invalid_field(
                name + ".set: is \"" + message.set() + "\"; " +
                (is_interchange() ? "\"a\", \"b\" or nothing" : "only interchange has sets"));
        const std::uint32_t most_groups = is_interchange() ? ExchangeAsset::max_groups : 0;
        if (message.group() > most_groups)
            return invalid_field(name + ".group: is " + std::to_string(message.group()) + "; " +
                                 (is_interchange() ? "from 1 to " + std::to_string(most_groups) +
                                                         ", or 0 for a patch that is shown alone"
                                                   : "only interchange has groups"));
        patch.group = static_cast<std::uint16_t>(message.group());
        if (patch.group != 0 && patch.set != ExchangeAsset::Set::none)
            return invalid_field(name + ".set: is \"" + message.set() + "\", but the patch is in group " +
                                 std::to_string(patch.group) + "; leave one of them out");
        return patch;
    }

    Result<ExchangeAsset::Content> read_content(const std::string& name, const proto::Content& message,
                                                const ExchangeAsset::Patch& patch) const {
        ExchangeAsset::Content content;
        // The box and half the blending width around it lie inside the exemplar
        const std::int32_t margin = asset_.blend_texels / 2;
        if (auto set = set_in_range(content.at.x, in_range(files_.json, name + ".x", message.x(), margin,
                                                           asset_.exemplar.width - patch.width - margin));
            !set)
            return set.error();
        if (auto set = set_in_range(content.at.y, in_range(files_.json, name + ".y", message.y(), margin,
                                                           asset_.exemplar.height - patch.height - margin));
            !set)
            return set.error();
        if (message.standing() == "pinned") {
            content.standing = ExchangeAsset::Standing::pinned;
        } else if (message.standing() == "dropped") {
            content.standing = ExchangeAsset::Standing::dropped;
        } else if (!message.standing().empty()) {
            return invalid_field(name + ".standing: is \"" + message.standing() +
                                 "\"; \"pinned\", \"dropped\" or nothing");
        }
        const std::string& corners = message.corners();
        const bool is_wang = asset_.method == ExchangeMethod::wang;
        if (corners.size() != (is_wang ? 4u : 0u) || corners.find_first_not_of("0123") != std::string::npos)
            return invalid_field(
                name + ".corners: is \"" + corners + "\"; " +
                (is_wang ? "four digits 0 to 3, the colours of top left, top right, bottom left, "
                           "bottom right"
                         : "only tiles of wang have corners"));
        for (std::size_t i = 0; i < corners.size(); ++i)
            content.corners =
                static_cast<std::uint8_t>(content.corners | static_cast<unsigned>(corners[i] - '0') << 2 * i);
        return content;
    }

    /// Every content's shape: cut out of the file, or all of its patch.
    Result<void> read_shapes() {
        std::int64_t texels = 0;
        for (const auto& patch : asset_.patches)
            texels += std::int64_t{patch.width} * patch.height * std::ssize(patch.contents);
        if (texels > max_sheet_texels)
            return invalid_field("patches_info: the boxes of all contents cover " +
                                 std::to_string(texels >> 20) + " Mtexels; at most " +
                                 std::to_string(max_sheet_texels >> 20));
        if (files_.shapes.empty()) {
            for (std::size_t p = 0; p < asset_.patches.size(); ++p) {
                const BitMask whole = whole_shape(asset_, p);
                for (auto& content : asset_.patches[p].contents) content.shape = whole;
            }
            return {};
        }
        const auto sheet = read_bit_image(files_.shapes, shapes_limits);
        if (!sheet) return sheet.error();
        for (std::size_t p = 0; p < asset_.patches.size(); ++p) {
            auto& patch = asset_.patches[p];
            for (std::size_t c = 0; c < patch.contents.size(); ++c) {
                const proto::Content& message =
                    message_.patches_info(static_cast<int>(p)).contents(static_cast<int>(c));
                const std::string name =
                    "patches_info[" + std::to_string(p) + "].contents[" + std::to_string(c) + "]";
                const char* whose = "the file of shapes";
                const auto x = in_range(files_.json, name + ".shape_x", message.shape_x(), 0,
                                        sheet->width - patch.width, whose);
                const auto y = in_range(files_.json, name + ".shape_y", message.shape_y(), 0,
                                        sheet->height - patch.height, whose);
                if (!x) return x.error();
                if (!y) return y.error();
                patch.contents[c].shape = cut_shape(*sheet, *x, *y, patch.width, patch.height);
            }
        }
        return {};
    }

    Result<void> read_channels() {
        std::set<std::string> names;
        for (int i = 0; i < message_.channels_size(); ++i) {
            const proto::Channel& message = message_.channels(i);
            const std::string field = "channels[" + std::to_string(i) + "]";
            const std::string& name = message.name();
            if (name != "normal" && name != "roughness" && name != "height")
                return invalid_field(field + ".name: is \"" + name + "\"; normal, roughness or height");
            if (!names.insert(name).second)
                return invalid_field(field + ".name: \"" + name + "\" is there twice");
            const auto exemplar =
                named_file(folder_, files_.json, field + ".exemplar", message.exemplar(), name + ".png");
            const auto tile =
                named_file(folder_, files_.json, field + ".tile", message.tile(), name + "-tile.png");
            if (!exemplar) return exemplar.error();
            if (!tile) return tile.error();
            ExchangeAsset::Channel channel{name, {}, {}};
            if (auto read = read_aligned(channel.exemplar, *exemplar, asset_.exemplar, files_.exemplar);
                !read)
                return read;
            if (auto read = read_aligned(channel.tile, *tile, asset_.tile, files_.tile); !read) return read;
            asset_.channels.push_back(std::move(channel));
        }
        return {};
    }

    static Result<void> read_aligned(Rgb8Image& image, const fs::path& file, const Rgb8Image& color,
                                     const fs::path& color_file) {
        auto read = read_rgb_image(file, exemplar_limits);
        if (!read) return read.error();
        if (auto fits = check_image_size(file, *read, color.width, color.height,
                                         color_file.filename().string() + ", which it belongs to, is");
            !fits)
            return fits;
        image = std::move(*read);
        return {};
    }

    const fs::path folder_;
    AssetFiles files_;
    proto::ExchangeAsset message_;
    ExchangeAsset asset_;
};

}  // namespace

Result<ExchangeAsset> read_exchange_asset(const fs::path& folder) { return AssetReader{folder}.read(); }

Result<Preparation> read_preparation(const fs::path& folder) {
    const auto message = AssetReader{folder}.read_message();
    if (!message) return message.error();
    const proto::Preparation& made = message->preparation();
    const auto number = [](std::uint32_t value) {
        return static_cast<std::int32_t>(std::min(value, 1u << 30));
    };
    Preparation preparation;
    preparation.method = method_of(*message).value_or(ExchangeMethod::content_exchange);
    preparation.version = made.version();
    preparation.photo = made.photo();
    preparation.seed = message->seed();
    preparation.tile_side = number(made.tile_side());
    preparation.patches = number(made.patches());
    preparation.contents = number(made.contents());
    preparation.colors = number(made.colors());
    preparation.blend_texels = made.has_blend_texels() ? number(made.blend_texels()) : -1;
    preparation.painted_patch_map = made.painted_patch_map();
    return preparation;
}

}  // namespace tessera
