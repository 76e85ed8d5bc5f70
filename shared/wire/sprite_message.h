#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "shared/result/result.h"
#include "shared/sprites/sprite.h"

namespace tessera {

namespace proto {
class SpriteAnimation;
class SpritePlacement;
}  // namespace proto

/// The set that a sprite's pattern is one of.
struct SpritePatterns {
    std::int32_t count = 0;
    std::int32_t side_texels = 0;
    std::span<const std::shared_ptr<const SpriteFrames>> animations{};  ///< Of the scene, by index.
};

/// Error: invalid_input; the message starts with the field ("frames[2].pattern: …").
Result<std::shared_ptr<const SpriteFrames>> sprite_frames_of(const proto::SpriteAnimation& message,
                                                             std::int32_t patterns);

/// Checked once, here: what comes out passes check_sprite(). Error: invalid_input; the message starts with
/// the field.
Result<Sprite> sprite_of(const proto::SpritePlacement& message, const SpritePatterns& patterns);

/// The message that sprite_of() makes `sprite` of.
void write_sprite(const Sprite& sprite, proto::SpritePlacement& message);

}  // namespace tessera
