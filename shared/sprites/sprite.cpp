#include "shared/sprites/sprite.h"

#include <algorithm>
#include <cstdlib>
#include <string>

namespace tessera {

namespace {

constexpr std::int64_t max_position = (std::int64_t{1} << 39) * sprite_units;
constexpr std::int64_t max_path_steps = (std::int64_t{1} << 31) - 1;

std::int64_t floor_div(std::int64_t a, std::int64_t b) noexcept {
    const std::int64_t q = a / b;
    return q * b > a ? q - 1 : q;
}

/// How far along a path a step is, and which way it goes from there.
struct PathPlace {
    std::int64_t at = 0;     ///< 0 to steps
    std::int64_t lasts = 0;  ///< Steps until the way turns or starts again; never_step: it stays.
    bool back = false;
};

PathPlace place_on(const SpritePath& path, std::int64_t step) noexcept {
    if (step < path.first_step) {
        // A path from the far past to the far future is longer than an int64
        const std::uint64_t wait =
            static_cast<std::uint64_t>(path.first_step) - static_cast<std::uint64_t>(step);
        return {0, static_cast<std::int64_t>(std::min<std::uint64_t>(wait, never_step)), false};
    }
    const std::uint64_t since =
        static_cast<std::uint64_t>(step) - static_cast<std::uint64_t>(path.first_step);
    const auto steps = static_cast<std::uint64_t>(path.steps);
    switch (path.then) {
        case SpritePath::Then::rest:
            if (since >= steps) return {path.steps, never_step, false};
            return {static_cast<std::int64_t>(since), static_cast<std::int64_t>(steps - since), false};
        case SpritePath::Then::repeat: {
            const std::uint64_t at = since % steps;
            return {static_cast<std::int64_t>(at), static_cast<std::int64_t>(steps - at), false};
        }
        case SpritePath::Then::reverse:
            break;
    }
    const std::uint64_t at = since % (2 * steps);
    if (at < steps) return {static_cast<std::int64_t>(at), static_cast<std::int64_t>(steps - at), false};
    return {static_cast<std::int64_t>(2 * steps - at), static_cast<std::int64_t>(2 * steps - at), true};
}

/// ⌊distance·at/steps⌋ and what is left over, without a product above 2^63: `at` and `steps` are below 2^31,
/// `distance` at least 0.
struct Share {
    std::int64_t whole = 0, rest = 0;
};
Share share(std::int64_t distance, std::int64_t at, std::int64_t steps) noexcept {
    const std::int64_t part = (distance % steps) * at;
    return {(distance / steps) * at + part / steps, part % steps};
}

std::int64_t along(std::int64_t from, std::int64_t to, std::int64_t at, std::int64_t steps) noexcept {
    const std::int64_t way = share(std::abs(to - from), at, steps).whole;
    return to < from ? from - way : from + way;
}

/// Steps until a coordinate's whole units change, while the way goes on as it does.
std::int64_t steps_until_moved(std::int64_t from, std::int64_t to, const PathPlace& place,
                               std::int64_t steps) noexcept {
    const std::int64_t distance = std::abs(to - from);
    if (distance == 0) return never_step;
    const std::int64_t rest = share(distance, place.at, steps).rest;
    return place.back ? rest / distance + 1 : (steps - rest + distance - 1) / distance;
}

/// Half the side of a square with sides along the axes around the turned and scaled pattern, in units.
std::int64_t half_side(const Sprite& sprite) noexcept {
    std::int64_t side = static_cast<std::int64_t>(sprite.side_texels) * sprite.scale;  // 65536ths of a texel
    // Turned by anything but quarters, by its diagonal: a turn then never changes the cells it lies in
    if (sprite.turn % 16384 != 0) side = side * 46341 / 32768 + 1;
    constexpr std::int64_t half_unit = 2 * 65536 / sprite_units;
    return (side + half_unit - 1) / half_unit;
}

TexelBox box_around(const Sprite& sprite, SpritePosition from, SpritePosition to) noexcept {
    const std::int64_t half = half_side(sprite);
    return {floor_div(std::min(from.x, to.x) - half, sprite_units),
            floor_div(std::min(from.y, to.y) - half, sprite_units),
            floor_div(std::max(from.x, to.x) + half + sprite_units - 1, sprite_units),
            floor_div(std::max(from.y, to.y) + half + sprite_units - 1, sprite_units)};
}

std::int64_t after(std::int64_t step, std::int64_t steps) noexcept {
    return steps >= never_step - std::max<std::int64_t>(step, 0) ? never_step : step + steps;
}

}  // namespace

bool same_sprite(const Sprite& a, const Sprite& b) noexcept {
    static constexpr SpriteLife ordinary;
    return a.id == b.id && a.x == b.x && a.y == b.y && a.pattern == b.pattern && a.order == b.order &&
           a.scale == b.scale && a.turn == b.turn && a.side_texels == b.side_texels &&
           (a.life ? *a.life : ordinary) == (b.life ? *b.life : ordinary);
}

SpritePosition position_at(const Sprite& sprite, std::int64_t step) noexcept {
    if (!sprite.life || !sprite.life->moves) return {sprite.x, sprite.y};
    const SpritePath& path = sprite.life->path;
    const PathPlace place = place_on(path, step);
    return {along(sprite.x, path.to_x, place.at, path.steps),
            along(sprite.y, path.to_y, place.at, path.steps)};
}

std::int64_t next_move(const Sprite& sprite, std::int64_t step) noexcept {
    if (!sprite.life) return never_step;
    const SpriteLife& life = *sprite.life;
    if (step >= life.end_step) return never_step;
    if (step < life.first_step) return life.first_step < life.end_step ? life.first_step : never_step;
    std::int64_t moved = never_step;
    if (life.moves) {
        const SpritePosition here = position_at(sprite, step);
        // Where the way turns it may stand for longer than a stretch of it lasts, but never through two
        std::int64_t now = step;
        for (int stretch = 0; stretch < 4 && moved == never_step && now != never_step; ++stretch) {
            const PathPlace place = place_on(life.path, now);
            if (place.lasts == never_step && life.path.then == SpritePath::Then::rest &&
                place.at == life.path.steps)
                break;
            const bool waits = now < life.path.first_step;
            const std::int64_t steps =
                waits ? never_step
                      : std::min(steps_until_moved(sprite.x, life.path.to_x, place, life.path.steps),
                                 steps_until_moved(sprite.y, life.path.to_y, place, life.path.steps));
            now = after(now, std::min(steps, place.lasts));
            if (now != never_step && position_at(sprite, now) != here) moved = now;
        }
    }
    return std::min(moved, life.end_step);
}

TexelBox box_at(const Sprite& sprite, std::int64_t step) noexcept {
    if (!there_at(sprite, step)) return {};
    const SpritePosition here = position_at(sprite, step);
    return box_around(sprite, here, here);
}

TexelBox box_of(const Sprite& sprite) noexcept {
    const SpritePosition here{sprite.x, sprite.y};
    if (!sprite.life || !sprite.life->moves) return box_around(sprite, here, here);
    return box_around(sprite, here, {sprite.life->path.to_x, sprite.life->path.to_y});
}

Result<void> check_sprite(const Sprite& sprite) {
    const auto wrong = [](const char* field, const char* range) {
        return Error{ErrorCode::invalid_input, std::string{field} + " is out of range; " + range};
    };
    const auto inside = [](std::int64_t v) { return v >= -max_position && v <= max_position; };
    if (sprite.id == 0) return wrong("id", "take any number but 0");
    if (!inside(sprite.x)) return wrong("x", "stay within ±2^39 texels");
    if (!inside(sprite.y)) return wrong("y", "stay within ±2^39 texels");
    if (sprite.side_texels < 1 || sprite.side_texels > 1024)
        return wrong("side_texels", "patterns are 1 to 1024 texels");
    if (sprite.scale < sprite_scale_one / 64 || sprite.scale > 4 * sprite_scale_one)
        return wrong("scale", "take 1/64 to 4");
    if (!sprite.life) return {};
    const SpriteLife& life = *sprite.life;
    if (life.end_step <= life.first_step) return wrong("end_step", "it is after first_step");
    if (life.rest < 0) return wrong("rest", "take at least 0");
    if (!life.moves) return {};
    if (!inside(life.path.to_x)) return wrong("path.to_x", "stay within ±2^39 texels");
    if (!inside(life.path.to_y)) return wrong("path.to_y", "stay within ±2^39 texels");
    if (life.path.steps < 1 || life.path.steps > max_path_steps)
        return wrong("path.steps", "take 1 to 2147483647");
    return {};
}

}  // namespace tessera
