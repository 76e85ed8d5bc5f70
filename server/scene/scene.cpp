#include "server/scene/scene.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <xxhash.h>

#include "proto/scene.pb.h"

#include "server/scene/asset_file.h"
#include "server/texture/constant_texture.h"
#include "server/texture/exchange.h"
#include "shared/page/page_format.h"
#include "shared/wire/json.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

/// Part of every fingerprint: raise it whenever any page of any scene changes by a bit.
constexpr std::string_view evaluator_version = "1";

constexpr std::uintmax_t max_scene_file_bytes = 1 << 20;

Error invalid(const fs::path& file, const std::string& what) {
    return {ErrorCode::invalid_input, file.string() + ": " + what};
}

bool is_scene_id(std::string_view id) {
    const auto allowed = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
               c == '_' || c == '.';
    };
    return !id.empty() && id.size() <= 64 && id.front() != '.' && std::all_of(id.begin(), id.end(), allowed);
}

Result<std::string> read_text(const fs::path& file) {
    std::error_code failure;
    const auto bytes = fs::file_size(file, failure);
    if (failure) return Error{ErrorCode::io_failure, file.string() + ": " + failure.message()};
    if (bytes > max_scene_file_bytes)
        return invalid(file, "is larger than 1 MiB; a scene file only names its assets");
    std::ifstream in{file, std::ios::binary};
    std::ostringstream text;
    text << in.rdbuf();
    if (!in) return Error{ErrorCode::io_failure, file.string() + ": cannot be read"};
    return text.str();
}

/// The path that a scene file names, kept inside the scene's folder, also through symbolic links.
Result<fs::path> inside(const fs::path& folder, const fs::path& file, std::string_view field,
                        const std::string& name) {
    if (name.empty())
        return invalid(file, std::string{field} + ": is missing; name a folder beside scene.json");
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

Result<std::shared_ptr<const Texture>> compile_content_exchange(const fs::path& folder, const fs::path& file,
                                                                const proto::ContentExchange& message) {
    const auto asset_folder = inside(folder, file, "content_exchange.asset", message.asset());
    if (!asset_folder) return asset_folder.error();
    ExchangeOptions options;
    options.seed = message.seed();
    options.blended = !message.unblended();
    options.types = message.types();
    if (options.types != 0 && (options.types < 64 || options.types > 16384 || (options.types & (options.types - 1)) != 0))
        return invalid(file, "content_exchange.types: is " + std::to_string(options.types) +
                                 "; a power of two from 64 to 16384");
    switch (message.choice()) {
        case proto::Choice::typed:
            options.choice = Choice::typed;
            break;
        case proto::Choice::independent:
            options.choice = Choice::independent;
            break;
        default:
            return invalid(file, "content_exchange.choice: \"typed\" or \"independent\"");
    }
    const auto asset = read_exchange_asset(*asset_folder);
    if (!asset) return asset.error();
    if (const std::size_t bytes = exchange_bytes(*asset, options); bytes > max_exchange_bytes)
        return invalid(file, "content_exchange.asset: \"" + message.asset() + "\" would take about " +
                                 std::to_string(bytes >> 20) + " MiB, more than " +
                                 std::to_string(max_exchange_bytes >> 20) +
                                 "; prepare it with a smaller tile, or fewer patches or contents");
    return std::shared_ptr<const Texture>{make_exchange_texture(*asset, options)};
}

Result<std::shared_ptr<const Texture>> compile(const fs::path& folder, const fs::path& file,
                                               const proto::Scene& message) {
    switch (message.texture_case()) {
        case proto::Scene::kConstant: {
            const auto color = to_color(file, "constant.color", message.constant().color());
            if (!color) return color.error();
            return make_constant_texture(*color);
        }
        case proto::Scene::kChecker:
            return compile_checker(file, message.checker());
        case proto::Scene::kContentExchange:
            return compile_content_exchange(folder, file, message.content_exchange());
        case proto::Scene::TEXTURE_NOT_SET:
            break;
    }
    return invalid(file, "has no texture; give it one of constant, checker, content_exchange");
}

/// Covers every file of the folder by relative name and content, and the versions of evaluator and encoders.
/// Of the scene file it takes `scene_text`, which was parsed, and not what the file may hold by now.
Result<std::string> fingerprint_of(const fs::path& folder, const std::string& scene_text) {
    std::vector<fs::path> files;
    std::error_code failure;
    for (fs::recursive_directory_iterator entry{folder, failure}, end; !failure && entry != end;
         entry.increment(failure))
        if (std::error_code odd; entry->is_regular_file(odd)) files.push_back(entry->path());
    if (failure) return Error{ErrorCode::io_failure, folder.string() + ": " + failure.message()};
    std::sort(files.begin(), files.end());
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state{XXH3_createState(), XXH3_freeState};
    XXH3_64bits_reset(state.get());
    const std::string versions = std::string{evaluator_version} + '/' + std::to_string(encoder_version);
    XXH3_64bits_update(state.get(), versions.data(), versions.size());
    const auto add_header = [&](const std::string& name, std::uintmax_t bytes) {
        const std::string header = name + '\0' + std::to_string(bytes) + '\0';
        XXH3_64bits_update(state.get(), header.data(), header.size());
    };
    add_header("scene.json", scene_text.size());
    XXH3_64bits_update(state.get(), scene_text.data(), scene_text.size());
    std::vector<char> block(1 << 16);
    for (const fs::path& path : files) {
        const std::string name = path.lexically_relative(folder).generic_string();
        if (name == "scene.json") continue;
        add_header(name, fs::file_size(path, failure));
        std::ifstream in{path, std::ios::binary};
        while (in.read(block.data(), std::ssize(block)) || in.gcount() > 0)
            XXH3_64bits_update(state.get(), block.data(), static_cast<std::size_t>(in.gcount()));
        if (in.bad()) return Error{ErrorCode::io_failure, path.string() + ": cannot be read"};
    }
    std::ostringstream hex;
    hex << std::hex;
    hex.width(16);
    hex.fill('0');
    hex << XXH3_64bits_digest(state.get());
    return hex.str();
}

Result<ScenePtr> load_once(const fs::path& folder, const std::string& id) {
    const fs::path file = folder / "scene.json";
    const auto text = read_text(file);
    if (!text) return text.error();
    proto::Scene message;
    if (auto read = read_json(*text, file.string(), message); !read) return read.error();

    auto scene = std::make_shared<Scene>();
    scene->id = id;
    if (!is_scene_id(scene->id))
        return invalid(folder, "a scene's folder is named with 1 to 64 of letters, digits, '-', '_' and '.'");
    scene->title = message.title().empty() ? scene->id : message.title();
    scene->attribution = message.attribution();
    const std::uint32_t n = message.extent_log2_pages() == 0 ? 20 : message.extent_log2_pages();
    if (n > max_level)
        return invalid(file,
                       "extent_log2_pages: is " + std::to_string(n) + "; from 1 to 30 (2^38 texels a side)");
    scene->extent.n = static_cast<std::uint8_t>(n);

    // The fingerprint must name the bytes that were compiled: where an asset changes meanwhile, all is read
    // again
    const auto before = fingerprint_of(folder, *text);
    if (!before) return before.error();
    auto texture = compile(folder, file, message);
    if (!texture) return texture.error();
    auto after = fingerprint_of(folder, *text);
    if (!after) return after.error();
    if (*before != *after) return Error{ErrorCode::page_changed, {}};
    scene->texture = *texture;
    scene->fingerprint = *after;
    return ScenePtr{std::move(scene)};
}

Result<ScenePtr> load_named(const fs::path& folder, const std::string& id) {
    // Input never throws on purpose, but memory may run out, and a folder may be odder than we think
    try {
        for (int attempt = 0; attempt < 3; ++attempt)
            if (auto scene = load_once(folder, id); scene || scene.error().code != ErrorCode::page_changed)
                return scene;
        return Error{ErrorCode::io_failure,
                     folder.string() + ": kept changing while it was read; load it again"};
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::io_failure, folder.string() + ": there is not enough memory for it"};
    } catch (const std::exception& unexpected) {
        return Error{ErrorCode::io_failure, folder.string() + ": " + unexpected.what()};
    }
}

}  // namespace

Result<ScenePtr> load_scene(const fs::path& folder) {
    std::error_code failure;
    const fs::path canonical = fs::weakly_canonical(folder, failure);
    return load_named(folder, (failure ? folder : canonical).filename().string());
}

ScenePtr Catalog::find(std::string_view id) const {
    const auto found = scenes.find(id);
    return found == scenes.end() ? nullptr : found->second;
}

Result<Catalog> load_catalog(const fs::path& folder, std::stop_token stop) {
    std::error_code failure;
    std::vector<fs::path> folders;
    if (fs::exists(folder / "scene.json", failure)) {
        folders.push_back(folder);
    } else {
        for (fs::directory_iterator entry{folder, failure}, end; !failure && entry != end;
             entry.increment(failure)) {
            std::error_code hidden;  // a folder that may not be looked into is not a scene of ours
            if (fs::exists(entry->path() / "scene.json", hidden) || (hidden && entry->is_directory(failure)))
                folders.push_back(entry->path());
        }
        if (failure)
            return Error{ErrorCode::io_failure, folder.string() + ": " + failure.message() +
                                                    "; name a folder of prepared scenes with --scenes"};
    }
    std::sort(folders.begin(), folders.end());

    Catalog catalog;
    for (const fs::path& path : folders) {
        if (stop.stop_requested()) return Error{ErrorCode::cancelled, "loading was stopped"};
        // The entry's own name, not what a link leads to: two links to folders of one name are two scenes
        fs::path name = path.filename();
        if (name.empty() || name == "." || name == "..")
            name = fs::weakly_canonical(path, failure).filename();
        if (name.string().starts_with('.')) continue;  // what a preparation has not finished
        if (auto scene = load_named(path, name.string())) {
            catalog.scenes.emplace((*scene)->id, *scene);
        } else {
            catalog.broken.push_back({name.string(), scene.error().detail});
        }
    }
    return catalog;
}

}  // namespace tessera
