#include "server/accuracy/measured_texture.h"

#include <cctype>

#include "server/prepare/prepare.h"
#include "server/scene/scene.h"
#include "server/scenes/paint_pebbles.h"
#include "server/scenes/painted_folder.h"
#include "server/scenes/pattern_scenes.h"
#include "shared/math/srgb.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

std::shared_ptr<const LinearImage> linear_of(const Rgb8Image& image) {
    auto linear = std::make_shared<LinearImage>(image.width, image.height);
    const std::size_t texels = linear->values.size() / 4;
    for (std::size_t i = 0; i < texels; ++i) {
        for (std::size_t c = 0; c < 3; ++c) linear->values[4 * i + c] = from_srgb(image.bytes[3 * i + c]);
        linear->values[4 * i + 3] = 1;
    }
    return linear;
}

std::shared_ptr<const LinearImage> linear_of(const StraightRgba8Image& image) {
    auto linear = std::make_shared<LinearImage>(image.width, image.height);
    const std::size_t texels = linear->values.size() / 4;
    for (std::size_t i = 0; i < texels; ++i) {
        const float alpha = static_cast<float>(image.bytes[4 * i + 3]) / 255;
        for (std::size_t c = 0; c < 3; ++c)
            linear->values[4 * i + c] = from_srgb(image.bytes[4 * i + c]) * alpha;
        linear->values[4 * i + 3] = alpha;
    }
    return linear;
}

Result<MeasuredTexture> content_exchange_texture(Progress& progress) {
    PrepareOptions options;
    options.tile_side = 256;
    auto prepared = prepare_exchange(paint_pebbles(512, 1, progress.stop()), options, nullptr, progress);
    if (!prepared) return prepared.error();
    return MeasuredTexture{"content-exchange", "Pebbles by content exchange, endless", nullptr,
                           make_exchange_texture(prepared->asset, {.seed = 1}), nullptr};
}

}  // namespace

const std::vector<std::string_view>& built_in_texture_names() {
    static const std::vector<std::string_view> names{"photograph", "checker", "text", "content-exchange",
                                                     "patterns"};
    return names;
}

MeasuredTexture photograph_texture(const std::stop_token& stop) {
    return {"photograph", "A photograph (painted pebbles)", linear_of(paint_pebbles(1024, 1, stop)), nullptr,
            nullptr};
}

Result<MeasuredTexture> painted_scene(std::string_view name, const fs::path& workshop) {
    const PaintedScene painted = paint_pattern_scene(name);
    const fs::path folder = workshop / name;
    if (const auto written = write_painted_folder(folder, painted, {}); !written) return written.error();
    const auto scene = load_scene(folder);
    if (!scene) return scene.error();
    return MeasuredTexture{std::string{name}, painted.scene.title(), nullptr, (*scene)->texture, nullptr};
}

Result<MeasuredTexture> built_in_texture(std::string_view name, const fs::path& workshop,
                                         Progress& progress) {
    if (name == "checker") return checker_texture();
    if (name == "text") return text_texture();
    if (name == "photograph") return photograph_texture(progress.stop());
    if (name == "content-exchange") return content_exchange_texture(progress);
    auto patterns = painted_scene("tiles", workshop);
    if (patterns) {
        patterns->name = "patterns";
        patterns->title = "Sixteen patterns in no order, endless";
    }
    return patterns;
}

std::string texture_name_of(std::string_view name) {
    std::string out;
    for (const char c : name)
        out += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.' ? c : '-';
    return out.empty() ? "texture" : out;
}

Result<MeasuredTexture> read_texture(const fs::path& path, const ImageLimits& limits) {
    std::error_code failure;
    const auto status = fs::status(path, failure);
    if (!fs::exists(status))
        return Error{ErrorCode::io_failure,
                     path.string() +
                         ": no such file or folder; name a scene's folder, an image or one of "
                         "the built-in textures"};
    if (fs::is_directory(status)) {
        const auto scene = load_scene(path);
        if (!scene) return scene.error();
        if ((*scene)->texture->texel_kind() == TexelKind::data)
            return Error{ErrorCode::invalid_input, path.string() + ": holds numbers and no colours"};
        return MeasuredTexture{texture_name_of((*scene)->id), (*scene)->title, nullptr, (*scene)->texture,
                               nullptr};
    }
    const auto image = read_rgba_image(path, limits);
    if (!image) return image.error();
    return MeasuredTexture{texture_name_of(path.stem().string()), path.filename().string(), linear_of(*image),
                           nullptr, nullptr};
}

}  // namespace tessera
