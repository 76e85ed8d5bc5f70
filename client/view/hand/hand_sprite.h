#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "client/residency/camera.h"
#include "shared/page/texel_box.h"
#include "shared/result/result.h"
#include "shared/sprites/sprite.h"

namespace tessera {

namespace proto {
class Change;
class SpritePlacement;
}  // namespace proto

/// A point of the plane as hands count it: 256ths of a texel of level 0, integers at every extent.
struct HandPoint {
    std::int64_t x = 0;
    std::int64_t y = 0;
    bool operator==(const HandPoint&) const = default;
};

HandPoint hand_point(const PlanePoint& at);
PlanePoint plane_point(const HandPoint& at);

/// A scene's animations by index.
using SpriteAnimations = std::vector<std::shared_ptr<const SpriteFrames>>;

/// A sprite as a hand holds it, with what it does not change. Its frames come by themselves (shown_pattern).
struct HandSprite : Sprite {
    std::optional<std::uint32_t> animation;
    std::int64_t phase = 0;
};

/// `side_texels`: of the patterns. Error: invalid_input.
Result<HandSprite> hand_sprite_of(const proto::SpritePlacement& message, std::int32_t patterns,
                                  std::int32_t side_texels);
void write_hand_sprite(const HandSprite& sprite, proto::SpritePlacement& message);
bool alike(const HandSprite& a, const HandSprite& b);

/// An id that nobody else draws.
SpriteId new_sprite_id();

/// What it shows at a step, as the pages do (pattern_at()); its own pattern while its animation is not known.
std::int32_t shown_pattern(const HandSprite& sprite, Step step, const SpriteAnimations& animations);
bool has_frames(const HandSprite& sprite, const SpriteAnimations& animations);

/// As one of the same kind that rests where it is at a step.
HandSprite resting_at(const HandSprite& sprite, Step step);

/// What a hand does to sprites: moved, and scaled and turned about a point.
struct HandChange {
    std::int64_t dx = 0, dy = 0;  ///< Units
    double scale = 1;
    double turns = 0;  ///< Clockwise
    HandPoint about{};
};
HandSprite changed(const HandSprite& sprite, const HandChange& how);

/// With this scale and turn, as far as sprites can have them.
void set_scale(HandSprite& sprite, double scale);
void set_turns(HandSprite& sprite, double turns);

/// The corners of a resting sprite, clockwise from its own top left: texels from its middle.
struct HandOffset {
    double x = 0;
    double y = 0;
};
std::array<HandOffset, 4> corners_of(const HandSprite& sprite);

/// A box around all of them, as they rest at a step.
TexelBox box_around(std::span<const HandSprite> sprites, Step step);

/// The changes that make `from` what `to` is; none if they are alike.
std::vector<proto::Change> changes_between(const HandSprite& from, const HandSprite& to);

}  // namespace tessera
