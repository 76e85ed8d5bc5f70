#pragma once

#include <string>
#include <string_view>

#include "server/scene/scene.h"

namespace tessera {

/// GET /scenes: proto::SceneList as JSON.
std::string describe_scenes(const Catalog& catalog);

/// GET /scenes/{id}: proto::TileJson as JSON. `origin` is scheme, host and port: "http://127.0.0.1:7070";
/// tile URLs are absolute, as TileJSON asks; `page_url` is a path, so that it holds behind any proxy.
std::string describe_tiles(const Scene& scene, std::string_view origin);

}  // namespace tessera
