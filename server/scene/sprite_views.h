#pragma once

#include <cstdint>
#include <vector>

#include "server/scene/scene.h"

namespace tessera {

/// What an editor draws with, as scenes that are made for one answer: their pages are evaluated, cached and
/// named like all others. `scene` has sprites.

/// The scene as `page` shows it without some of its sprites: an editor lifts them from the page, and draws
/// them where the hand is. The scene itself where none of them meets the page, or where so many sprites do
/// that looking for them would take long.
ScenePtr scene_without(const ScenePtr& scene, const std::vector<SpriteId>& lifted, PageKey page);

/// A pattern of the sprites alone, over nothing: page (0, 0) of its coarsest level, with the pattern in the
/// top-left corner; one larger than a page fills it. `pattern` is from 0 on, below sprite_images->count().
ScenePtr pattern_scene(const Scene& scene, std::int32_t pattern);

}  // namespace tessera
