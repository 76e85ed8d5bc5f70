#include "client/view/hand/hand_sprite.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "proto/edit.pb.h"

#include "shared/wire/sprite_message.h"

namespace tessera {
namespace {

constexpr std::int64_t farthest = (std::int64_t{1} << 39) * sprite_units;

double texels(std::int64_t units) { return static_cast<double>(units) / sprite_units; }

HandPoint moved(const HandPoint& point, const HandChange& how, double cosine, double sine) {
    // Relative to the middle of the change: exact wherever that is
    const auto u = static_cast<double>(point.x - how.about.x), v = static_cast<double>(point.y - how.about.y);
    const bool still = how.scale == 1 && how.turns == 0;
    const auto whole = [&](std::int64_t about, double offset, std::int64_t at, std::int64_t step) {
        const std::int64_t to = still ? at : about + static_cast<std::int64_t>(std::floor(offset + 0.5));
        return std::clamp(to + step, -farthest, farthest);
    };
    return {whole(how.about.x, u * cosine - v * sine, point.x, how.dx),
            whole(how.about.y, u * sine + v * cosine, point.y, how.dy)};
}

}  // namespace

HandPoint hand_point(const PlanePoint& at) {
    const auto part = [](double fraction) {
        return static_cast<std::int64_t>(std::floor(fraction * sprite_units + 0.5));
    };
    return {at.x * sprite_units + part(at.fraction_x), at.y * sprite_units + part(at.fraction_y)};
}

PlanePoint plane_point(const HandPoint& at) {
    return {at.x >> 8, at.y >> 8, texels(at.x & (sprite_units - 1)), texels(at.y & (sprite_units - 1))};
}

Result<HandSprite> hand_sprite_of(const proto::SpritePlacement& message, std::int32_t patterns,
                                  std::int32_t side_texels) {
    proto::SpritePlacement without = message;
    without.clear_animation();
    const auto sprite = sprite_of(without, {patterns, side_texels, {}});
    if (!sprite) return sprite.error();
    HandSprite made;
    static_cast<Sprite&>(made) = *sprite;
    if (message.has_animation()) made.animation = message.animation();
    made.phase = message.phase();
    return made;
}

void write_hand_sprite(const HandSprite& sprite, proto::SpritePlacement& message) {
    write_sprite(sprite, message);
    if (!sprite.animation) return;
    message.set_animation(*sprite.animation);
    message.set_phase(sprite.phase);
}

bool alike(const HandSprite& a, const HandSprite& b) {
    return same_sprite(a, b) && a.animation == b.animation && a.phase == b.phase;
}

SpriteId new_sprite_id() {
    std::random_device random;
    const SpriteId id = (SpriteId{random()} & 0x7fffffff) << 32 | SpriteId{random()};
    return id == 0 ? 1 : id;
}

bool has_frames(const HandSprite& sprite, const SpriteAnimations& animations) {
    return sprite.animation && *sprite.animation < animations.size();
}

std::int32_t shown_pattern(const HandSprite& sprite, Step step, const SpriteAnimations& animations) {
    if (!has_frames(sprite, animations)) return sprite.pattern;
    SpriteLife life;
    life.frames = animations[*sprite.animation];
    life.phase = sprite.phase;
    Sprite shown;
    shown.life = std::make_shared<const SpriteLife>(std::move(life));
    return pattern_at(shown, step);
}

HandSprite resting_at(const HandSprite& sprite, Step step) {
    HandSprite resting = sprite;
    const SpritePosition at = position_at(sprite, step);
    resting.x = at.x;
    resting.y = at.y;
    if (resting.life && resting.life->moves) {
        auto life = std::make_shared<SpriteLife>(*resting.life);
        life->moves = false;
        life->path = {};
        resting.life = std::move(life);
    }
    return resting;
}

void set_scale(HandSprite& sprite, double scale) {
    constexpr double one = sprite_scale_one;
    sprite.scale = static_cast<std::uint32_t>(std::floor(std::clamp(scale, 1.0 / 64, 4.0) * one + 0.5));
}

void set_turns(HandSprite& sprite, double turns) {
    const double part = turns - std::floor(turns);
    sprite.turn = static_cast<std::uint16_t>(static_cast<std::uint32_t>(part * 65536 + 0.5));
}

HandSprite changed(const HandSprite& sprite, const HandChange& how) {
    const double angle = 2 * std::numbers::pi * how.turns;
    const double cosine = std::cos(angle) * how.scale, sine = std::sin(angle) * how.scale;
    HandSprite result = sprite;
    const HandPoint at = moved({sprite.x, sprite.y}, how, cosine, sine);
    result.x = at.x;
    result.y = at.y;
    if (sprite.life && sprite.life->moves) {
        auto life = std::make_shared<SpriteLife>(*sprite.life);
        const HandPoint to = moved({life->path.to_x, life->path.to_y}, how, cosine, sine);
        life->path.to_x = to.x;
        life->path.to_y = to.y;
        result.life = std::move(life);
    }
    if (how.scale != 1) set_scale(result, how.scale * sprite.scale / double{sprite_scale_one});
    if (how.turns != 0) set_turns(result, sprite.turn / 65536.0 + how.turns);
    return result;
}

std::array<HandOffset, 4> corners_of(const HandSprite& sprite) {
    const double half = sprite.side_texels * (sprite.scale / double{sprite_scale_one}) / 2;
    const double angle = 2 * std::numbers::pi * sprite.turn / 65536.0;
    const double c = half * std::cos(angle), s = half * std::sin(angle);
    return {{{-c + s, -s - c}, {c + s, s - c}, {c - s, s + c}, {-c - s, -s + c}}};
}

TexelBox box_around(std::span<const HandSprite> sprites, Step step) {
    TexelBox box;
    for (const HandSprite& sprite : sprites) {
        HandSprite resting = resting_at(sprite, step);
        resting.life.reset();
        box = hull(box, box_of(resting));
    }
    return box;
}

std::vector<proto::Change> changes_between(const HandSprite& from, const HandSprite& to) {
    std::vector<proto::Change> changes;
    const bool other_path =
        from.life && to.life && from.life->moves && to.life->moves && !(from.life->path == to.life->path);
    if (other_path) {
        // A move leaves the path where it is: the sprite is taken away, and placed with all of its way
        changes.emplace_back().mutable_remove_sprite()->set_id(from.id);
        write_hand_sprite(to, *changes.emplace_back().mutable_place_sprite());
        return changes;
    }
    proto::SpriteMove move;
    move.set_id(to.id);
    if (from.x != to.x) move.set_x(texels(to.x));
    if (from.y != to.y) move.set_y(texels(to.y));
    if (from.scale != to.scale) move.set_scale(to.scale / double{sprite_scale_one});
    if (from.turn != to.turn) move.set_turn(to.turn / 65536.0);
    if (from.order != to.order) move.set_order(to.order);
    if (from.pattern != to.pattern) move.set_pattern(static_cast<std::uint32_t>(to.pattern));
    if (move.has_x() || move.has_y() || move.has_scale() || move.has_turn() || move.has_order() ||
        move.has_pattern())
        *changes.emplace_back().mutable_move_sprite() = move;
    return changes;
}

}  // namespace tessera
