#include "shared/sprites/sprite.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "shared/motion/cycle.h"

namespace tessera {

namespace {

constexpr std::int64_t max_position = (std::int64_t{1} << 39) * sprite_units;
constexpr std::int64_t max_path_steps = (std::int64_t{1} << 31) - 1;

std::int64_t floor_div(std::int64_t a, std::int64_t b) noexcept {
    const std::int64_t q = a / b;
    return q * b > a ? q - 1 : q;
}

/// How far along a path a step is, and which way it goes there.
struct PathPlace {
    std::int64_t at = 0;  ///< 0 to steps
    Validity stretch;     ///< The steps around in which the way does not turn or start again.
    bool goes = false;    ///< Or it stays where it is.
    bool back = false;
};

PathPlace place_on(const SpritePath& path, Step step) noexcept {
    if (step < path.first_step) return {.stretch = {always, path.first_step}};
    const std::uint64_t since =
        static_cast<std::uint64_t>(step) - static_cast<std::uint64_t>(path.first_step);
    const auto steps = static_cast<std::uint64_t>(path.steps);
    const auto stretch_from = [&](std::uint64_t done) {
        const Step from = add_steps(step, -static_cast<std::int64_t>(done));
        return Validity{from, add_steps(from, path.steps)};
    };
    switch (path.then) {
        case SpritePath::Then::rest:
            if (since >= steps) return {path.steps, {add_steps(path.first_step, path.steps), never}};
            return {static_cast<std::int64_t>(since), stretch_from(since), true};
        case SpritePath::Then::repeat:
            return {static_cast<std::int64_t>(since % steps), stretch_from(since % steps), true};
        case SpritePath::Then::reverse:
            break;
    }
    const std::uint64_t at = since % (2 * steps);
    if (at < steps) return {static_cast<std::int64_t>(at), stretch_from(at), true};
    return {static_cast<std::int64_t>(2 * steps - at), stretch_from(at - steps), true, true};
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

/// The steps around `step`, inside its stretch, in which a coordinate stays in one unit.
Validity stay_of(std::int64_t from, std::int64_t to, const PathPlace& place, std::int64_t steps,
                 Step step) noexcept {
    const std::int64_t distance = std::abs(to - from);
    if (distance == 0 || !place.goes) return place.stretch;
    // A unit is where distance·at/steps has one floor: so far along it, and so far to go, in 1/steps units
    const std::int64_t entered = share(distance, place.at, steps).rest;
    const std::int64_t since = (place.back ? steps - 1 - entered : entered) / distance;
    const std::int64_t left =
        place.back ? entered / distance + 1 : (steps - entered + distance - 1) / distance;
    Validity stay{add_steps(step, -since), add_steps(step, left)};
    stay.meet(place.stretch);
    return stay;
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

/// In which a path leaves its sprite in one place.
Validity stay_on(const Sprite& sprite, Step step) noexcept {
    const SpritePath& path = sprite.life->path;
    const auto in_stretch = [&](Step at) {
        const PathPlace place = place_on(path, at);
        Validity stay = stay_of(sprite.x, path.to_x, place, path.steps, at);
        stay.meet(stay_of(sprite.y, path.to_y, place, path.steps, at));
        return stay;
    };
    // Where the way turns it may stand on; but what stands through two more stretches stands for ever
    const SpritePosition here = position_at(sprite, step);
    Validity stay = in_stretch(step);
    for (int more = 0; more < 3 && stay.until != never && position_at(sprite, stay.until) == here; ++more)
        stay.until = more < 2 ? in_stretch(stay.until).until : never;
    for (int more = 0; more < 3 && stay.from != always && position_at(sprite, stay.from - 1) == here; ++more)
        stay.from = more < 2 ? in_stretch(stay.from - 1).from : always;
    return stay;
}

}  // namespace

bool same_sprite(const Sprite& a, const Sprite& b) noexcept {
    static const SpriteLife ordinary;
    return a.id == b.id && a.x == b.x && a.y == b.y && a.pattern == b.pattern && a.order == b.order &&
           a.scale == b.scale && a.turn == b.turn && a.side_texels == b.side_texels &&
           (a.life ? *a.life : ordinary) == (b.life ? *b.life : ordinary);
}

SpritePosition position_at(const Sprite& sprite, Step step) noexcept {
    if (!sprite.life || !sprite.life->moves) return {sprite.x, sprite.y};
    const SpritePath& path = sprite.life->path;
    const PathPlace place = place_on(path, step);
    return {along(sprite.x, path.to_x, place.at, path.steps),
            along(sprite.y, path.to_y, place.at, path.steps)};
}

std::int32_t pattern_at(const Sprite& sprite, Step step) noexcept {
    if (!sprite.life || !sprite.life->frames) return sprite.pattern;
    const SpriteFrames& frames = *sprite.life->frames;
    return frames
        .patterns[static_cast<std::size_t>(shown_at(frames.line, {.phase = sprite.life->phase}, step).frame)];
}

Validity stay_of(const Sprite& sprite, Step step) noexcept {
    if (!sprite.life) return {};
    const SpriteLife& life = *sprite.life;
    if (step < life.first_step) return {always, life.first_step};
    if (step >= life.end_step) return {life.end_step, never};
    Validity stay = life.moves ? stay_on(sprite, step) : Validity{};
    if (life.frames) stay.meet(shown_at(life.frames->line, {.phase = life.phase}, step).validity);
    stay.meet({life.first_step, life.end_step});
    return stay;
}

TexelBox box_at(const Sprite& sprite, Step step) noexcept {
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
    if (!life.moves) return {};
    if (!inside(life.path.to_x)) return wrong("path.to_x", "stay within ±2^39 texels");
    if (!inside(life.path.to_y)) return wrong("path.to_y", "stay within ±2^39 texels");
    if (life.path.steps < 1 || life.path.steps > max_path_steps)
        return wrong("path.steps", "take 1 to 2147483647");
    return {};
}

}  // namespace tessera
