#include "server/scene/compile_scene.h"

#include <algorithm>

#include "proto/scene.pb.h"

#include "server/scene/compile_exchange.h"
#include "server/scene/compile_pattern.h"
#include "server/scene/compile_sprites.h"
#include "server/scene/scene.h"
#include "server/scene/scene_document.h"
#include "server/texture/constant_texture.h"
#include "server/texture/exchange.h"
#include "shared/wire/target_message.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

Error invalid(const fs::path& file, const std::string& what) {
    return {ErrorCode::invalid_input, file.string() + ": " + what};
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

Result<void> compile_exchange(const fs::path& folder, const fs::path& file, ExchangeMethod method,
                              const proto::Exchange& message, Scene& scene) {
    const std::string field{method_name(method)};
    const auto read = read_exchange(folder, field, method, message);
    if (!read) return Error{read.error().code, file.string() + ": " + read.error().detail};
    if (const std::size_t bytes = read->bytes * (1 + channel_textures(read->asset));
        bytes > max_exchange_bytes)
        return invalid(file, too_large_exchange(field, message.asset(), bytes).detail);
    const auto albedo = make_exchange_texture(read->asset, read->options);
    scene.channels = make_channels(albedo, read->asset);
    scene.texture = albedo;
    return {};
}

Result<void> set(Result<std::shared_ptr<const Texture>> texture, Scene& scene) {
    if (!texture) return texture.error();
    scene.texture = std::move(*texture);
    return {};
}

Result<void> compile_texture(const fs::path& folder, const fs::path& file, const proto::Scene& message,
                             BlockFiles& files, PatternKept* kept, Scene& scene) {
    const auto targets = targets_of(message.targets());
    if (!targets) return invalid(file, "targets" + targets.error().detail);
    switch (message.texture_case()) {
        case proto::Scene::kConstant: {
            const auto color = to_color(file, "constant.color", message.constant().color());
            if (!color) return color.error();
            return set(make_constant_texture(*color), scene);
        }
        case proto::Scene::kChecker:
            return set(compile_checker(file, message.checker()), scene);
        case proto::Scene::kContentExchange:
            return compile_exchange(folder, file, ExchangeMethod::content_exchange,
                                    message.content_exchange(), scene);
        case proto::Scene::kInterchange:
            return compile_exchange(folder, file, ExchangeMethod::interchange, message.interchange(), scene);
        case proto::Scene::kWang:
            return compile_exchange(folder, file, ExchangeMethod::wang, message.wang(), scene);
        case proto::Scene::kPattern:
            return compile_pattern(files, kept, file, message.pattern(), *targets, scene);
        case proto::Scene::TEXTURE_NOT_SET:
            break;
    }
    return invalid(
        file,
        "has no texture; give it one of constant, checker, content_exchange, interchange, wang, pattern");
}

Result<void> compile_clock(const fs::path& file, const proto::Clock& clock, Scene& scene) {
    const double rate = clock.steps_per_second();
    if (!(rate == 0 || (rate > 0 && rate <= 1000)))
        return invalid(file, "clock.steps_per_second: is no number above 0 and at most 1000");
    if (rate > 0) scene.steps_per_second = rate;
    if (clock.loop_steps() < 0 || clock.loop_steps() > max_step)
        return invalid(file,
                       "clock.loop_steps: is " + std::to_string(clock.loop_steps()) + "; from 0 to 2^62");
    scene.loop_steps = clock.loop_steps();
    return {};
}

}  // namespace

Result<void> compile_ground(const fs::path& folder, const fs::path& file, const proto::Scene& message,
                            BlockFiles& files, PatternKept* kept, Scene& scene) {
    if (auto texture = compile_texture(folder, file, message, files, kept, scene); !texture) return texture;
    return compile_clock(file, message.clock(), scene);
}

Result<void> compile_scene(const fs::path& folder, const fs::path& file, const proto::Scene& message,
                           Scene& scene) {
    // What edits go on with
    auto document = std::make_shared<const SceneDocument>(folder, message);
    if (auto ground = document->compile(message, {}, scene); !ground) return ground;
    if (message.has_sprites())
        if (auto sprites = compile_sprites(folder, file, message.sprites(), scene); !sprites) return sprites;
    if (takes_edits(message, scene)) scene.document = std::move(document);
    return {};
}

}  // namespace tessera
