#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "proto/edit.pb.h"

#include "server/journal/edit_id.h"
#include "server/scene/scene.h"
#include "server/sprites/sprite_texture.h"
#include "server/texture/constant_texture.h"
#include "shared/math/hash.h"

namespace tessera {

/// A checker under sprites of four noisy patterns of 16 texels, none placed.
inline ScenePtr made_scene() {
    PatternImages patterns{.side = 16, .count = 4, .slices = 1, .codes = {}};
    for (std::int64_t i = 0; i < 16 * 16 * 4 * 4; ++i)
        patterns.codes.push_back(static_cast<std::uint8_t>(hash(5, 1, i, 0)));
    auto scene = std::make_shared<Scene>();
    scene->id = "made";
    scene->extent = {10};
    scene->fingerprint = "0123456789abcdef";
    scene->ground = make_checker_texture(8, {250, 240, 230, 255}, {20, 60, 90, 255});
    scene->sprite_images = std::make_shared<const SpriteImages>(patterns, std::size_t{1} << 20);
    scene->texture = make_sprite_texture(scene->ground, scene->sprite_images, scene->sprites);
    return scene;
}

inline proto::Edit new_edit() {
    proto::Edit edit;
    edit.set_id(to_string(random_edit_id()));
    return edit;
}

inline proto::Edit placing(std::uint64_t id, double x, double y, std::uint32_t pattern = 0) {
    proto::Edit edit = new_edit();
    proto::SpritePlacement& sprite = *edit.add_changes()->mutable_place_sprite();
    sprite.set_id(id);
    sprite.set_x(x);
    sprite.set_y(y);
    sprite.set_pattern(pattern);
    return edit;
}

inline proto::Edit moving(std::uint64_t id, double x, double y) {
    proto::Edit edit = new_edit();
    proto::SpriteMove& move = *edit.add_changes()->mutable_move_sprite();
    move.set_id(id);
    move.set_x(x);
    move.set_y(y);
    return edit;
}

inline proto::Edit removing(std::uint64_t id) {
    proto::Edit edit = new_edit();
    edit.add_changes()->mutable_remove_sprite()->set_id(id);
    return edit;
}

/// Texels of [0, side)² of a level.
inline std::vector<float> texels_of(const Scene& scene, std::uint8_t level = 0, std::int32_t side = 256) {
    LinearImage out;
    scene.texture
        ->evaluate({.level = level, .width = side >> level, .height = side >> level},
                   {.accuracy = Accuracy::exact}, out)
        .value();
    return out.values;
}

}  // namespace tessera
