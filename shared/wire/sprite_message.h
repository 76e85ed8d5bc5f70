#pragma once

#include <cstdint>

#include "shared/result/result.h"
#include "shared/sprites/sprite.h"

namespace tessera {

namespace proto {
class SpritePlacement;
}

/// The set that a sprite's pattern is one of.
struct SpritePatterns {
    std::int32_t count = 0;
    std::int32_t side_texels = 0;
};

/// Checked once, here: what comes out passes check_sprite(). Error: invalid_input; the message starts with
/// the field.
Result<Sprite> sprite_of(const proto::SpritePlacement& message, const SpritePatterns& patterns);

/// The message that sprite_of() makes `sprite` of.
void write_sprite(const Sprite& sprite, proto::SpritePlacement& message);

}  // namespace tessera
