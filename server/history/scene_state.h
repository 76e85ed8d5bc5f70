#pragma once

#include <memory>
#include <vector>

#include "proto/edit.pb.h"
#include "proto/scene.pb.h"
#include "proto/sprite.pb.h"

#include "server/blocks/editable_map.h"
#include "server/edits/live_scene.h"

namespace tessera {

using SpriteList = std::vector<proto::SpritePlacement>;

/// What edits can change of a scene.
struct SceneState {
    SpriteList sprites;  ///< By id.
    /// Of the scene file, without sprites, and for `maps` without their entries.
    proto::Scene document;
    std::shared_ptr<const std::vector<EditableMap>> maps;  ///< Null: none.
    proto::ClockState clock;
};

SceneState state_of(const LiveScene& scene);

/// Whether the pages of both are the same at every step from that on at which transitions are over.
bool alike(const SceneState& a, const SceneState& b);

}  // namespace tessera
