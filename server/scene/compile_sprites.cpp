#include "server/scene/compile_sprites.h"

#include <memory>
#include <numeric>
#include <string>
#include <unordered_set>

#include "proto/sprite.pb.h"

#include "server/scene/pattern_files.h"
#include "server/scene/scene.h"
#include "server/sprites/sprite_texture.h"
#include "shared/wire/sprite_message.h"

namespace tessera {
namespace {

constexpr int max_placed = 1'000'000;
/// Of one scene's turned and scaled sprites.
constexpr std::size_t image_cache_bytes = std::size_t{64} << 20;

}  // namespace

Result<void> compile_sprites(const std::filesystem::path& folder, const std::filesystem::path& file,
                             const proto::Sprites& message, Scene& scene) {
    const auto invalid = [&](const std::string& what) {
        return Error{ErrorCode::invalid_input, file.string() + ": sprites" + what};
    };
    if (scene.texture->texel_kind() != TexelKind::color) return invalid(": lie over colours only");
    if (message.overlap_layers() > PositioningMap::max_overlap_layers)
        return invalid(".overlap_layers: is " + std::to_string(message.overlap_layers()) + "; from 1 to " +
                       std::to_string(PositioningMap::max_overlap_layers));
    if (message.placed_size() > max_placed)
        return invalid(".placed: lists " + std::to_string(message.placed_size()) + "; at most " +
                       std::to_string(max_placed));
    PatternFiles files{folder};
    const auto patterns = files.read_patterns("sprites.patterns", message.patterns());
    if (!patterns) return Error{patterns.error().code, file.string() + ": " + patterns.error().detail};

    constexpr int max_animations = 4096;
    if (message.animations_size() > max_animations)
        return invalid(".animations: lists " + std::to_string(message.animations_size()) + "; at most 4096");
    std::vector<std::shared_ptr<const SpriteFrames>> animations;
    for (int i = 0; i < message.animations_size(); ++i) {
        auto frames = sprite_frames_of(message.animations(i), patterns->count);
        if (!frames) return invalid(".animations[" + std::to_string(i) + "]." + frames.error().detail);
        animations.push_back(std::move(*frames));
    }
    PositioningMap map{message.overlap_layers() == 0 ? PositioningMap::max_overlap_layers
                                                     : std::size_t{message.overlap_layers()}};
    std::unordered_set<SpriteId> ids;
    for (int i = 0; i < message.placed_size(); ++i) {
        const auto wrong = [&](const std::string& what) {
            return invalid(".placed[" + std::to_string(i) + "]" + what);
        };
        const auto sprite = sprite_of(message.placed(i), {patterns->count, patterns->side, animations});
        if (!sprite) return wrong("." + sprite.error().detail);
        if (!ids.insert(sprite->id).second)
            return wrong(".id: is " + std::to_string(sprite->id) + ", as another sprite's; ids differ");
        if (auto placed = map.place(*sprite); !placed) return wrong(": " + placed.error().detail);
    }
    scene.slices = scene.slices == 0 ? 0 : std::lcm(scene.slices, patterns->slices);
    scene.ground_animated = scene.animated;
    scene.animated = scene.animated || map.living() > 0;
    scene.ground = scene.texture;
    scene.sprite_images =
        std::make_shared<const SpriteImages>(*patterns, image_cache_bytes, std::move(animations));
    scene.sprites = std::move(map);
    scene.texture = make_sprite_texture(scene.ground, scene.sprite_images, scene.sprites);
    return {};
}

}  // namespace tessera
