#include "shared/wire/sprite_message.h"

#include <cmath>
#include <string>

#include "proto/sprite.pb.h"

#include "shared/page/page_key.h"

namespace tessera {

namespace {

Error out_of_range(const char* field, const std::string& range) {
    return {ErrorCode::invalid_input, std::string{field} + ": " + range};
}

/// Texels to units, down; nothing for what is no place.
bool to_units(double texels, std::int64_t& units) noexcept {
    if (!(std::fabs(texels) <= 0x1p39)) return false;
    units = static_cast<std::int64_t>(std::floor(texels * sprite_units));
    return true;
}

double to_texels(std::int64_t units) noexcept { return static_cast<double>(units) / sprite_units; }

Result<SpritePath> path_of(const proto::SpritePath& message) {
    SpritePath path;
    if (!to_units(message.to_x(), path.to_x) || !to_units(message.to_y(), path.to_y))
        return out_of_range("path", "to_x and to_y are texels within ±2^39");
    path.first_step = message.first_step();
    path.steps = message.steps();
    switch (message.then()) {
        case proto::SpritePath::rest:
            path.then = SpritePath::Then::rest;
            return path;
        case proto::SpritePath::repeat:
            path.then = SpritePath::Then::repeat;
            return path;
        case proto::SpritePath::reverse:
            path.then = SpritePath::Then::reverse;
            return path;
        default:
            return out_of_range("path.then", "is rest, repeat or reverse");
    }
}

}  // namespace

Result<std::shared_ptr<const SpriteFrames>> sprite_frames_of(const proto::SpriteAnimation& message,
                                                             std::int32_t patterns) {
    constexpr int max_frames = 4096;
    if (message.frames().empty() || message.frames_size() > max_frames)
        return out_of_range("frames", "are " + std::to_string(message.frames_size()) + "; 1 to 4096");
    std::vector<std::int32_t> shown;
    std::vector<std::uint32_t> steps;
    for (int i = 0; i < message.frames_size(); ++i) {
        const proto::SpriteAnimation::Frame& frame = message.frames(i);
        const std::string field = "frames[" + std::to_string(i) + "]";
        if (frame.pattern() >= static_cast<std::uint32_t>(patterns))
            return out_of_range((field + ".pattern").c_str(), "is " + std::to_string(frame.pattern()) +
                                                                  "; the set has " +
                                                                  std::to_string(patterns) + ", from 0 on");
        if (frame.has_steps() && frame.steps() == 0)
            return out_of_range((field + ".steps").c_str(), "is 0; at least 1, or leave the frame out");
        shown.push_back(static_cast<std::int32_t>(frame.pattern()));
        steps.push_back(frame.has_steps() ? frame.steps() : 1);
    }
    return std::make_shared<const SpriteFrames>(SpriteFrames{std::move(shown), TimeLine{steps}});
}

Result<Sprite> sprite_of(const proto::SpritePlacement& message, const SpritePatterns& patterns) {
    Sprite sprite;
    sprite.id = message.id();
    if (!to_units(message.x(), sprite.x) || !to_units(message.y(), sprite.y))
        return out_of_range("x, y", "are texels within ±2^39");
    if (message.pattern() >= static_cast<std::uint32_t>(patterns.count))
        return out_of_range("pattern", "is " + std::to_string(message.pattern()) + "; the set has " +
                                           std::to_string(patterns.count) + ", from 0 on");
    sprite.pattern = static_cast<std::int32_t>(message.pattern());
    sprite.side_texels = static_cast<std::uint16_t>(patterns.side_texels);
    const double scale = message.has_scale() ? message.scale() : 1.0;
    if (!(scale >= 1.0 / 64 && scale <= 4)) return out_of_range("scale", "is from 1/64 to 4");
    sprite.scale = static_cast<std::uint32_t>(std::floor(scale * sprite_scale_one + 0.5));
    if (!(message.turn() >= 0 && message.turn() <= 1)) return out_of_range("turn", "is from 0 to 1");
    sprite.turn = static_cast<std::uint16_t>(static_cast<std::uint32_t>(message.turn() * 65536 + 0.5));
    sprite.order = message.order();
    if (message.phase() < -max_step || message.phase() > max_step)
        return out_of_range("phase", "is from -2^62 to 2^62");
    if (message.has_first_step() || message.has_end_step() || message.has_path() || message.has_animation()) {
        SpriteLife life;
        if (message.has_animation()) {
            if (message.animation() >= patterns.animations.size())
                return out_of_range("animation",
                                    "is " + std::to_string(message.animation()) + "; the scene has " +
                                        std::to_string(patterns.animations.size()) + ", from 0 on");
            life.animation = message.animation();
            life.frames = patterns.animations[life.animation];
            life.phase = message.phase();
        }
        if (message.has_first_step()) life.first_step = message.first_step();
        if (message.has_end_step()) life.end_step = message.end_step();
        if (message.has_path()) {
            auto path = path_of(message.path());
            if (!path) return path.error();
            life.path = *path;
            life.moves = true;
        }
        sprite.life = std::make_shared<const SpriteLife>(life);
    }
    if (auto checked = check_sprite(sprite); !checked) return checked.error();
    return sprite;
}

void write_sprite(const Sprite& sprite, proto::SpritePlacement& message) {
    message.Clear();
    message.set_id(sprite.id);
    message.set_pattern(static_cast<std::uint32_t>(sprite.pattern));
    message.set_x(to_texels(sprite.x));
    message.set_y(to_texels(sprite.y));
    if (sprite.scale != sprite_scale_one)
        message.set_scale(sprite.scale / static_cast<double>(sprite_scale_one));
    message.set_turn(sprite.turn / 65536.0);
    message.set_order(sprite.order);
    if (!sprite.life) return;
    const SpriteLife& life = *sprite.life;
    if (life.first_step != always) message.set_first_step(life.first_step);
    if (life.end_step != never) message.set_end_step(life.end_step);
    if (life.frames) {
        message.set_animation(life.animation);
        message.set_phase(life.phase);
    }
    if (!life.moves) return;
    proto::SpritePath& path = *message.mutable_path();
    path.set_to_x(to_texels(life.path.to_x));
    path.set_to_y(to_texels(life.path.to_y));
    path.set_first_step(life.path.first_step);
    path.set_steps(static_cast<std::uint32_t>(life.path.steps));
    switch (life.path.then) {
        case SpritePath::Then::rest:
            path.set_then(proto::SpritePath::rest);
            break;
        case SpritePath::Then::repeat:
            path.set_then(proto::SpritePath::repeat);
            break;
        case SpritePath::Then::reverse:
            path.set_then(proto::SpritePath::reverse);
            break;
    }
}

}  // namespace tessera
