#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

#include "server/tiled/scene_builder.h"

namespace tessera {
namespace {

constexpr double least_scale = 1.0 / 64, most_scale = 4;  ///< Of sprites.

/// What a pattern holds: a tile, as large as it is painted, as its layer shows it.
struct Painted {
    std::size_t layer;
    std::uint32_t gid;
    std::int32_t width, height;
    auto operator<=>(const Painted&) const = default;
};

/// An object as a sprite.
struct Placed {
    const TileObject* object;
    Painted painted;
    double scale;
    double x, y;  ///< The middle of what is painted, in texels of the scene.
};

struct Plan {
    std::vector<Placed> sprites;
    std::map<Painted, std::int32_t> patterns;
    std::int64_t side = 1;  ///< Of a pattern.
    std::size_t too_large = 0, unknown = 0;
};

using Frames = std::vector<std::pair<std::int32_t, std::uint32_t>>;  ///< Pattern and steps.

class Sprites {
  public:
    Sprites(SceneBuilder& builder, std::int32_t first_x, std::int32_t first_y, std::uint32_t step)
        : builder_{builder}, first_x_{first_x}, first_y_{first_y}, step_{step} {
        const double side = builder.painter.side();
        per_x_ = side / builder.map().tile_width;
        per_y_ = side / builder.map().tile_height;
    }

    Result<std::size_t> add(Progress& progress) {
        // Patterns of one size, as large as their image has room for
        std::int64_t limit = max_tile_texels;
        Plan plan = planned(limit);
        while (std::ssize(plan.patterns) > SceneBuilder::most_patterns(plan.side) && limit > 1) {
            limit /= 2;
            plan = planned(limit);
        }
        say_what_is_missing(plan, limit);
        if (plan.sprites.empty()) return std::size_t{0};
        std::vector<std::uint8_t> codes;
        std::int32_t count = 0;
        for (auto& [painted, number] : plan.patterns) {
            if (progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
            number = count++;
            const ObjectLayer& layer = builder_.map().objects[painted.layer];
            builder_.painter.paint_alone({painted.gid}, painted.width, painted.height,
                                         static_cast<std::int32_t>(plan.side), layer.opacity, layer.tint,
                                         codes);
        }
        proto::Sprites& sprites = *builder_.scene().scene.mutable_sprites();
        *sprites.mutable_patterns() = builder_.add_sheet("sprites.png", plan.side, codes);
        for (const Placed& placed : plan.sprites) place(plan, placed, sprites);
        say_what_is_made(plan);
        return plan.sprites.size();
    }

  private:
    const TileAnimation* animation_of(TileRef tile) const {
        const Tileset& set = *builder_.painter.tileset_of(tile);
        const auto found = set.animations.find(tile.number() - set.first);
        return found == set.animations.end() ? nullptr : &found->second;
    }
    /// A frame of an animated tile, flipped as that is.
    TileRef frame(TileRef tile, const TileAnimation::Frame& frame) const {
        return {(tile.gid & (7u << 29)) | (builder_.painter.tileset_of(tile)->first + frame.tile)};
    }
    /// The tiles that an object shows, one after the other; those that are missing are not among them.
    std::vector<TileRef> shown(TileRef tile) const {
        const TileAnimation* const animation = animation_of(tile);
        if (animation == nullptr) return {tile};
        std::vector<TileRef> tiles;
        for (const auto& of : animation->frames)
            if (builder_.painter.find(frame(tile, of)) != nullptr) tiles.push_back(frame(tile, of));
        return tiles;
    }

    /// All sprites, none painted larger than `limit` texels a side.
    Plan planned(std::int64_t limit) const {
        Plan plan;
        for (std::size_t i = 0; i < builder_.map().objects.size(); ++i)
            for (const TileObject& object : builder_.map().objects[i].objects) {
                const TileRef tile{object.tile.gid & ~TileRef::turned_hexagon};
                if (builder_.painter.find(tile) == nullptr || shown(tile).empty()) {
                    ++plan.unknown;
                    continue;
                }
                const auto placed = fitted(i, object, tile, static_cast<double>(limit));
                if (!placed) {
                    ++plan.too_large;
                    continue;
                }
                const auto longest = std::max(placed->painted.width, placed->painted.height);
                plan.side =
                    std::max(plan.side, std::int64_t{std::bit_ceil(static_cast<std::uint32_t>(longest))});
                for (const TileRef of : shown(tile)) {
                    Painted painted = placed->painted;
                    painted.gid = of.gid;
                    plan.patterns.try_emplace(painted, 0);
                }
                plan.sprites.push_back(*placed);
            }
        return plan;
    }

    /// Scale and painted size: the tile's own texels along x where scales and the limit allow.
    std::optional<Placed> fitted(std::size_t layer, const TileObject& object, TileRef tile,
                                 double limit) const {
        const TileImage& image = *builder_.painter.find(tile);
        const Tileset& set = *builder_.painter.tileset_of(tile);
        const bool transposed = tile.has(TileRef::transposed);
        const double own_width = transposed ? image.height : image.width;
        const double own_height = transposed ? image.width : image.height;
        const double width = object.width > 0 ? object.width : own_width;
        const double height = object.height > 0 ? object.height : own_height;
        const double across = width * per_x_, down = height * per_y_;  // Texels of the scene
        const double room = std::max(across, down) / limit;
        const double scale = std::clamp(std::max(across / own_width, room), least_scale, most_scale);
        if (scale < room) return std::nullopt;

        const auto texels = [scale](double length) {
            return std::max(1, static_cast<std::int32_t>(std::llround(length / scale)));
        };
        Placed placed{&object, {layer, tile.gid, texels(across), texels(down)}, scale, 0, 0};
        // From the point that the object turns about to the middle of the tile
        const double x = (0.5 - set.align_x) * width + set.offset_x * width / own_width;
        const double y = (0.5 - set.align_y) * height + set.offset_y * height / own_height;
        const ObjectLayer& of = builder_.map().objects[layer];
        const auto [turned_x, turned_y] = turned(object.turn, x, y);
        placed.x =
            (object.x + of.offset_x + turned_x - double(first_x_) * builder_.map().tile_width) * per_x_;
        placed.y =
            (object.y + of.offset_y + turned_y - double(first_y_) * builder_.map().tile_height) * per_y_;
        return placed;
    }

    /// Quarters of a turn are exact.
    static std::pair<double, double> turned(double turn, double x, double y) {
        const double quarters = turn * 4;
        if (quarters == 0) return {x, y};
        if (quarters == 1) return {-y, x};
        if (quarters == 2) return {-x, -y};
        if (quarters == 3) return {y, -x};
        const double angle = turn * 2 * std::numbers::pi;
        return {std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y};
    }

    void place(const Plan& plan, const Placed& placed, proto::Sprites& sprites) {
        proto::SpritePlacement& sprite = *sprites.add_placed();
        const auto number = static_cast<std::uint64_t>(sprites.placed_size());
        // Where a side of the painting is odd, its middle is half a texel off the pattern's
        const auto off = [&](std::int32_t length) {
            return (plan.side - length) % 2 == 0 ? 0 : placed.scale / 2;
        };
        const auto [x, y] =
            turned(placed.object->turn, off(placed.painted.width), off(placed.painted.height));
        sprite.set_id(number);
        sprite.set_x(placed.x + x);
        sprite.set_y(placed.y + y);
        if (placed.scale != 1) sprite.set_scale(placed.scale);
        if (placed.object->turn != 0) sprite.set_turn(placed.object->turn);
        sprite.set_order(static_cast<std::int32_t>(number));
        const TileRef tile{placed.painted.gid};
        const auto pattern_of = [&](TileRef of) {
            Painted painted = placed.painted;
            painted.gid = of.gid;
            return plan.patterns.at(painted);
        };
        sprite.set_pattern(static_cast<std::uint32_t>(pattern_of(shown(tile).front())));
        const TileAnimation* const animation = animation_of(tile);
        if (animation == nullptr || shown(tile).size() != animation->frames.size()) return;
        Frames frames;
        for (const auto& of : animation->frames)
            frames.emplace_back(pattern_of(frame(tile, of)), std::max(1u, of.milliseconds / step_));
        sprite.set_animation(animation_number(std::move(frames), sprites));
    }

    std::uint32_t animation_number(Frames frames, proto::Sprites& sprites) {
        const auto [found, is_new] =
            animations_.try_emplace(std::move(frames), static_cast<std::uint32_t>(animations_.size()));
        if (is_new) {
            proto::SpriteAnimation& animation = *sprites.add_animations();
            for (const auto& [pattern, steps] : found->first) {
                auto& own = *animation.add_frames();
                own.set_pattern(static_cast<std::uint32_t>(pattern));
                own.set_steps(steps);
            }
        }
        return found->second;
    }

    void say_what_is_missing(const Plan& plan, std::int64_t limit) {
        auto& left_out = builder_.scene().left_out;
        const auto sprites = [](std::size_t count) {
            return count == 1 ? std::string{"one sprite"} : std::to_string(count) + " sprites";
        };
        if (plan.unknown > 0)
            left_out.push_back(sprites(plan.unknown) + " of object layers: no tileset has the tile");
        if (plan.too_large > 0)
            left_out.push_back(sprites(plan.too_large) + " of object layers: larger than " +
                               std::to_string(limit * 4) + " texels");
        if (limit < max_tile_texels)
            left_out.push_back("sprites are painted with at most " + std::to_string(limit) +
                               " texels a side, as many as an image of them all has room for");
    }

    void say_what_is_made(const Plan& plan) {
        const TiledMap& map = builder_.map();
        std::vector<std::size_t> counts(map.objects.size());
        std::size_t turned = 0;
        for (const Placed& placed : plan.sprites) {
            ++counts[placed.painted.layer];
            turned += placed.object->turn != 0;
        }
        for (std::size_t i = 0; i < counts.size(); ++i) {
            if (counts[i] == 0) continue;
            const std::string who = "object layer \"" + map.objects[i].name + "\": ";
            builder_.scene().made.push_back(
                who + (counts[i] == 1 ? "a sprite" : std::to_string(counts[i]) + " sprites"));
            if (const std::size_t over = map.layers.size() - map.objects[i].above; over > 0)
                builder_.scene().left_out.push_back(
                    who + "lies below " + (over == 1 ? "a layer" : std::to_string(over) + " layers") +
                    " of tiles in the map; sprites lie over them all");
        }
        if (turned > 0 && per_x_ != per_y_)
            builder_.scene().left_out.push_back(
                "the picture is stretched, and turned sprites are not stretched as they are turned");
    }

    SceneBuilder& builder_;
    std::int32_t first_x_, first_y_;
    std::uint32_t step_;
    double per_x_ = 1, per_y_ = 1;  ///< Texels of the scene for one of the map.
    std::map<Frames, std::uint32_t> animations_;
};

}  // namespace

Result<std::size_t> add_sprites(SceneBuilder& builder, std::int32_t first_x, std::int32_t first_y,
                                std::uint32_t step_milliseconds, Progress& progress) {
    return Sprites{builder, first_x, first_y, step_milliseconds}.add(progress);
}

}  // namespace tessera
