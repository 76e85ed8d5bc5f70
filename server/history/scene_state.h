#pragma once

#include <vector>

#include "proto/sprite.pb.h"

#include "server/edits/live_scene.h"

namespace tessera {

using SpriteList = std::vector<proto::SpritePlacement>;

/// What edits can change of a scene.
struct SceneState {
    SpriteList sprites;  ///< By id.
};

SceneState state_of(const LiveScene& scene);

bool operator==(const SceneState& a, const SceneState& b);

}  // namespace tessera
