#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/scene/scene.h"
#include "server/sprites/sprite_texture.h"
#include "server/texture/constant_texture.h"
#include "shared/math/hash.h"
#include "tests/support/made_edits.h"

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
