#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "shared/motion/time_line.h"
#include "shared/motion/validity.h"
#include "shared/page/texel_box.h"
#include "shared/result/result.h"

namespace tessera {

using SpriteId = std::uint64_t;

/// Positions are counted in 256ths of a texel: fine enough for a hand, exact at every extent.
inline constexpr std::int64_t sprite_units = 256;
/// Scales are counted in 65536ths.
inline constexpr std::uint32_t sprite_scale_one = 65536;

/// How a sprite moves by itself: evenly along a line, from its own position to another.
struct SpritePath {
    enum class Then : std::uint8_t {
        rest,     ///< Stays at the end.
        repeat,   ///< Starts again.
        reverse,  ///< Goes back, and so on.
    };
    std::int64_t to_x = 0, to_y = 0;  ///< Units; where it is `steps` after `first_step`.
    Step first_step = 0;              ///< Before it, the sprite is at its own position.
    std::int64_t steps = 1;           ///< 1 to 2^31 − 1.
    Then then = Then::rest;
    bool operator==(const SpritePath&) const = default;
};

/// Patterns one after the other, again and again: one of a scene's animations, shared by its sprites.
struct SpriteFrames {
    std::vector<std::int32_t> patterns;
    TimeLine line;
};

/// What only some sprites have; shared by copies of a sprite.
struct SpriteLife {
    Step first_step = always;  ///< There from this step on …
    Step end_step = never;     ///< … and before this one.
    SpritePath path;
    bool moves = false;                            ///< Whether there is a path.
    std::shared_ptr<const SpriteFrames> frames{};  ///< Null: it shows its pattern.
    std::uint32_t animation = 0;                   ///< The index of its frames in the scene.
    std::int64_t phase = 0;                        ///< Steps that it is ahead.
    bool operator==(const SpriteLife&) const = default;
};

/// A pattern that was put somewhere by hand (Lefebvre and Neyret 2003, section 3.2, explicit positioning and
/// tile transform). Everything about it is an integer: where and when it is never depends on rounding.
struct Sprite {
    SpriteId id = 0;
    std::int64_t x = 0, y = 0;               ///< Its middle, in units of the infinite lattice of level 0.
    std::int32_t pattern = 0;                ///< Index in the scene's pattern set.
    std::int32_t order = 0;                  ///< The greater, the nearer to the eye; equals by id.
    std::uint32_t scale = sprite_scale_one;  ///< 1/64 to 4
    std::uint16_t turn = 0;                  ///< 65536ths of a turn, clockwise (y is down).
    std::uint16_t side_texels = 0;           ///< Of the pattern, 1 to 1024.
    std::shared_ptr<const SpriteLife> life;  ///< Null: always there, at rest.
};

/// Whether `a` is drawn before, and so below, `b`.
inline bool drawn_before(const Sprite& a, const Sprite& b) noexcept {
    return a.order != b.order ? a.order < b.order : a.id < b.id;
}

/// Everything alike.
bool same_sprite(const Sprite& a, const Sprite& b) noexcept;

/// Its middle at a step, whether it is there or not.
struct SpritePosition {
    std::int64_t x = 0, y = 0;
    bool operator==(const SpritePosition&) const = default;
};
SpritePosition position_at(const Sprite& sprite, Step step) noexcept;

inline bool there_at(const Sprite& sprite, Step step) noexcept {
    return !sprite.life || (sprite.life->first_step <= step && step < sprite.life->end_step);
}

/// What it shows at a step, whether it is there or not.
std::int32_t pattern_at(const Sprite& sprite, Step step) noexcept;

/// The steps around `step` in which the sprite is in one place and shows one frame, or is not there: at
/// `until` it moves, changes, appears or disappears. Found from the laws.
Validity stay_of(const Sprite& sprite, Step step) noexcept;

/// The texels that it may colour at a step; empty when it is not there.
TexelBox box_at(const Sprite& sprite, Step step) noexcept;

/// The texels that it may colour at any step.
TexelBox box_of(const Sprite& sprite) noexcept;

/// invalid_input, naming the field and its range.
Result<void> check_sprite(const Sprite& sprite);

}  // namespace tessera
