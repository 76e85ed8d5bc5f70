#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "proto/scene.pb.h"

#include "server/scenes/pattern_scenes.h"
#include "shared/page/texel_image.h"

namespace tessera::moving {

// What scenes that move are written with
proto::Block& add(proto::Scene& scene, const std::string& name);
proto::Block& block_named(proto::Scene& scene, const std::string& name);
/// A pattern set and its image, both called `name`.
void add_patterns(PaintedScene& painted, const std::string& name, const std::vector<Rgba8Image>& patterns);
/// An animation sequence called "frames": pattern and steps.
void add_frames(proto::Scene& scene, const std::vector<std::pair<std::int32_t, std::uint32_t>>& frames);

PaintedScene paint_flower_field();
PaintedScene paint_road();

}  // namespace tessera::moving
