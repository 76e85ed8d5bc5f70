#pragma once

#include <string>
#include <vector>

#include "proto/scene.pb.h"

#include "server/progress/progress.h"
#include "server/scene/image_file.h"
#include "server/tiled/tiled_map.h"
#include "shared/result/result.h"

namespace tessera {

/// A map as a scene of pattern blocks, with the images that these name.
struct TiledScene {
    struct Sheet {
        std::string file;
        StraightRgba8Image image;
    };
    struct Map {
        std::string file;
        LabelImage image;
    };
    proto::Scene scene;
    std::vector<Sheet> sheets;
    std::vector<Map> maps;
    std::vector<std::string> made;      ///< What became what: a sentence each.
    std::vector<std::string> left_out;  ///< What could not: a sentence each.

    /// Both lists, for people.
    std::string report() const;
};

/// Layers of tiles become reference textures over explicit indirection maps, one over the other, and tiles at
/// free places sprites over them. What the
/// tilesets hold beside tiles becomes blocks that the map itself does not show, for whoever goes on with the
/// scene: probabilities a probability map, complete terrains transition tiles, animations sequences. Errors:
/// invalid_input (too many different cells), cancelled.
Result<TiledScene> to_scene(const TiledMap& map, const std::string& title, Progress& progress);

}  // namespace tessera
