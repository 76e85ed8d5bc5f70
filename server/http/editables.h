#pragma once

#include <string>

#include "server/scene/scene.h"

namespace tessera {

/// GET /scenes/{id}/editables: proto::SceneEditables as JSON.
std::string describe_editables(const Scene& scene);

}  // namespace tessera
