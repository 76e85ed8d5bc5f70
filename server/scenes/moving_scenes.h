#pragma once

#include <string_view>
#include <vector>

#include "server/scenes/pattern_scenes.h"

namespace tessera {

/// The animated case studies of Lefebvre & Neyret (sections 3.4, 4 and 6) as scenes: names of samples.
const std::vector<std::string_view>& moving_scene_names();

/// Paints one of moving_scene_names(); by the same rules as paint_pattern_scene().
PaintedScene paint_moving_scene(std::string_view name);

}  // namespace tessera
