#include "server/scene/compile_scene.h"

#include <algorithm>

#include "proto/scene.pb.h"

#include "server/scene/asset_file.h"
#include "server/scene/scene.h"
#include "server/texture/constant_texture.h"
#include "server/texture/exchange.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

Error invalid(const fs::path& file, const std::string& what) {
    return {ErrorCode::invalid_input, file.string() + ": " + what};
}

/// The path that a scene file names, kept inside the scene's folder, also through symbolic links.
Result<fs::path> inside(const fs::path& folder, const fs::path& file, const std::string& field,
                        const std::string& name) {
    if (name.empty()) return invalid(file, field + ": is missing; name a folder beside scene.json");
    std::error_code failure;
    const fs::path root = fs::weakly_canonical(folder, failure);
    const fs::path target = fs::weakly_canonical(folder / name, failure);
    const auto [root_end, rest] = std::mismatch(root.begin(), root.end(), target.begin(), target.end());
    if (failure || fs::path{name}.is_absolute() || root_end != root.end())
        return invalid(file, std::string{field} + ": \"" + name +
                                 "\" leaves the scene's folder; copy the asset into it");
    return target;
}

Result<Rgba8> to_color(const fs::path& file, std::string_view field, const proto::Color& color) {
    const std::uint32_t alpha = color.has_alpha() ? color.alpha() : 255;
    if (std::max({color.red(), color.green(), color.blue(), alpha}) > 255)
        return invalid(file, std::string{field} + ": channels are sRGB codes from 0 to 255");
    return Rgba8{static_cast<std::uint8_t>(color.red()), static_cast<std::uint8_t>(color.green()),
                 static_cast<std::uint8_t>(color.blue()), static_cast<std::uint8_t>(alpha)};
}

Result<std::shared_ptr<const Texture>> compile_checker(const fs::path& file, const proto::Checker& checker) {
    const std::uint32_t cell = checker.cell_texels() == 0 ? 32 : checker.cell_texels();
    if (cell > 1u << 20)
        return invalid(file, "checker.cell_texels: is " + std::to_string(cell) + "; at most 1048576");
    auto first = checker.has_first() ? to_color(file, "checker.first", checker.first())
                                     : Result<Rgba8>{Rgba8{255, 255, 255, 255}};
    auto second = checker.has_second() ? to_color(file, "checker.second", checker.second())
                                       : Result<Rgba8>{Rgba8{0, 0, 0, 255}};
    if (!first) return first.error();
    if (!second) return second.error();
    return make_checker_texture(cell, *first, *second);
}

/// One of the three fields that hold an Exchange: its name is its method's.
struct ExchangeField {
    ExchangeMethod method;
    const proto::Exchange& message;
};

Result<ExchangeOptions> to_options(const fs::path& file, const ExchangeField& field) {
    const std::string name{method_name(field.method)};
    ExchangeOptions options;
    options.seed = field.message.seed();
    options.blended = !field.message.unblended();
    options.types = field.message.types();
    if (options.types != 0 &&
        (options.types < 64 || options.types > 16384 || (options.types & (options.types - 1)) != 0))
        return invalid(
            file, name + ".types: is " + std::to_string(options.types) + "; a power of two from 64 to 16384");
    switch (field.message.choice()) {
        case proto::Choice::typed:
            options.choice = Choice::typed;
            return options;
        case proto::Choice::independent:
            options.choice = Choice::independent;
            if (field.method == ExchangeMethod::content_exchange) return options;
            break;
        case proto::Choice::kolar:
            options.choice = Choice::kolar;
            if (field.method == ExchangeMethod::interchange) return options;
            break;
        default:
            break;
    }
    static constexpr const char* allowed[] = {"\"typed\" or \"independent\"", "\"typed\" or \"kolar\"",
                                              "\"typed\" only"};
    return invalid(file, name + ".choice: " + allowed[static_cast<std::size_t>(field.method)]);
}

/// Both sets have patches: else nothing is ever exchanged.
bool has_both_sets(const ExchangeAsset& asset) {
    const auto has = [&](ExchangeAsset::Set set) {
        return std::ranges::count(asset.patches, set, &ExchangeAsset::Patch::set) > 0;
    };
    return has(ExchangeAsset::Set::a) && has(ExchangeAsset::Set::b);
}

Result<void> compile_exchange(const fs::path& folder, const fs::path& file, const ExchangeField& field,
                              Scene& scene) {
    const std::string name{method_name(field.method)}, asset_name = field.message.asset();
    const auto asset_folder = inside(folder, file, name + ".asset", asset_name);
    if (!asset_folder) return asset_folder.error();
    const auto options = to_options(file, field);
    if (!options) return options.error();
    const auto asset = read_exchange_asset(*asset_folder);
    if (!asset) return asset.error();
    if (asset->method != field.method)
        return invalid(file, name + ".asset: \"" + asset_name + "\" was prepared for " +
                                 std::string{method_name(asset->method)} +
                                 "; name the field so, or prepare it with --method " + name);
    if (options->choice == Choice::kolar && !has_both_sets(*asset))
        return invalid(file, name + ".choice: \"kolar\" needs patches of both sets, which \"" + asset_name +
                                 "\" has not; prepare it again, or choose \"typed\"");
    const std::size_t bytes = exchange_bytes(*asset, *options) * (1 + channel_textures(*asset));
    if (bytes > max_exchange_bytes)
        return invalid(
            file, name + ".asset: \"" + asset_name + "\" would take about " + std::to_string(bytes >> 20) +
                      " MiB, more than " + std::to_string(max_exchange_bytes >> 20) +
                      "; prepare it with a smaller tile, or fewer patches, contents or aligned images");
    const auto albedo = make_exchange_texture(*asset, *options);
    scene.channels = make_channels(albedo, *asset);
    scene.texture = albedo;
    return {};
}

Result<void> set(Result<std::shared_ptr<const Texture>> texture, Scene& scene) {
    if (!texture) return texture.error();
    scene.texture = std::move(*texture);
    return {};
}

}  // namespace

Result<void> compile_scene(const fs::path& folder, const fs::path& file, const proto::Scene& message,
                           Scene& scene) {
    switch (message.texture_case()) {
        case proto::Scene::kConstant: {
            const auto color = to_color(file, "constant.color", message.constant().color());
            if (!color) return color.error();
            return set(make_constant_texture(*color), scene);
        }
        case proto::Scene::kChecker:
            return set(compile_checker(file, message.checker()), scene);
        case proto::Scene::kContentExchange:
            return compile_exchange(folder, file,
                                    {ExchangeMethod::content_exchange, message.content_exchange()}, scene);
        case proto::Scene::kInterchange:
            return compile_exchange(folder, file, {ExchangeMethod::interchange, message.interchange()},
                                    scene);
        case proto::Scene::kWang:
            return compile_exchange(folder, file, {ExchangeMethod::wang, message.wang()}, scene);
        case proto::Scene::TEXTURE_NOT_SET:
            break;
    }
    return invalid(file,
                   "has no texture; give it one of constant, checker, content_exchange, interchange, wang");
}

}  // namespace tessera
