#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "server/scene/image_file.h"
#include "server/scene/scene.h"
#include "shared/math/hash.h"
#include "tests/support/temporary_folder.h"

namespace tessera {

/// A scene folder whose blocks people may edit: transition tiles of two families under a dithered map that is
/// clamped, a pixel map, leaves that hang over, an animation, one that looks at targets, and one that
/// requests drive, where a map says so; under sprites.
class EditedPattern {
  public:
    EditedPattern() {
        write("tiles.png", 8, 32);
        write("leaves.png", 8, 4);
    }
    std::filesystem::path folder() const { return folder_.path / "meadow"; }

    ScenePtr load(const std::string& output = "all", bool with_sprites = true) const {
        std::ofstream{folder() / "scene.json"} << json(output, with_sprites);
        return load_scene(folder()).value();
    }

    static std::string json(const std::string& output, bool with_sprites) {
        std::string combinations;
        for (int i = 0; i < 16; ++i)
            combinations += std::string{i == 0 ? "" : ","} + R"({"corners": [)" + std::to_string(i & 1) +
                            "," + std::to_string(i >> 1 & 1) + "," + std::to_string(i >> 2 & 1) + "," +
                            std::to_string(i >> 3 & 1) + R"(], "patterns": {"entries": [{"pattern": )" +
                            std::to_string(2 * i) + R"(}, {"pattern": )" + std::to_string(2 * i + 1) + "}]}}";
        const auto zeros = [](int count, int every) {
            std::string text;
            for (int i = 0; i < count; ++i)
                text += std::string{i == 0 ? "" : ","} + (i % every == 0 ? "1" : "0");
            return text;
        };
        return R"({"extent_log2_pages": 6, "targets": [{"id": 1, "x": 3000, "y": 3000}],
          "clock": {"steps_per_second": 10},)" +
               std::string{with_sprites
                               ? R"("sprites": {"patterns": {"image": "leaves.png", "side_texels": 8}},)"
                               : ""} +
               R"( "pattern": {"output": ")" + output + R"(", "blocks": [
            {"name": "cells", "virtual_tile_map": {"cell_texels": 8}},
            {"name": "tiles", "pattern_set": {"image": "tiles.png", "side_texels": 8}},
            {"name": "leaves", "pattern_set": {"image": "leaves.png", "side_texels": 8}},
            {"name": "areas", "editable": ["map"], "dithered_areas_map": {"areas": {"grid": "cells", "cells": 8,
                "edge": "clamp", "width": 16, "values": [)" +
               zeros(256, 7) + R"(]}}},
            {"name": "which", "editable": ["count"], "virtual_indirection_map": {"grid": "cells", "count": 64,
                "generator": "independent"}},
            {"name": "borders", "transition_tiles": {"material": {"block": "areas"}, "index": {"block": "which"},
                "families": 2, "combinations": [)" +
               combinations + R"(]}},
            {"name": "ground", "reference_texture": {"patterns": "tiles", "grid": "cells",
                "index": {"block": "borders"}}},
            {"name": "kinds", "editable": ["map"], "areas_map": {"grid": "cells", "cells": 4, "edge": "clamp", "x": 512, "y": 512,
                "width": 32, "values": [)" +
               zeros(1024, 5) + R"(]}},
            {"name": "mixture", "editable": ["materials"], "materials_map": {"material": {"block": "kinds"},
                "index": {"block": "which"}, "materials": [{"entries": [{"pattern": -1}]},
                {"entries": [{"pattern": 0}, {"pattern": 1}]}, {"entries": [{"pattern": -1, "weight": 2},
                {"pattern": 2}]}]}},
            {"name": "place", "tile_transform": {"grid": "cells", "x": {"block": "at"}, "overflow": true,
                "scale": {"number": 0.9}}},
            {"name": "at", "virtual_random_map": {"grid": "cells"}},
            {"name": "fallen", "reference_texture": {"patterns": "leaves", "grid": "cells",
                "index": {"block": "mixture"}, "transform": "place"}},
            {"name": "plain", "constant": {"red": 40, "green": 90, "blue": 50}},
            {"name": "mask", "editable": ["map"], "pixel_map": {"textures": ["ground", "plain"], "edge": "clamp",
                "texels": 16, "width": 64, "values": [)" +
               zeros(4096, 11) + R"(]}},
            {"name": "frames", "animation_sequence": {"frames": [{"pattern": 0}, {"pattern": 1},
                {"pattern": 2, "steps": 2}]}},
            {"name": "phase", "virtual_indirection_map": {"grid": "cells", "count": 8,
                "generator": "independent"}},
            {"name": "blink", "editable": ["animation"], "animation_map": {"sequence": "frames",
                "phase": {"block": "phase"}, "rest": {"integer": 20}}},
            {"name": "lights", "reference_texture": {"patterns": "leaves", "grid": "cells",
                "index": {"block": "blink"}}},
            {"name": "open", "animation_map": {"sequence": "frames",
                "target_distance": {"near_texels": 8, "far_texels": 64}}},
            {"name": "flowers", "reference_texture": {"patterns": "leaves", "grid": "cells",
                "index": {"block": "open"}}},
            {"name": "view", "animation_map": {"sequence": "frames", "request_parameter": {}}},
            {"name": "seen", "materials_map": {"material": {"block": "kinds"}, "index": {"block": "view"},
                "materials": [{"entries": [{"pattern": -1}, {"pattern": -1}, {"pattern": -1}]},
                {"entries": [{"pattern": 3}, {"pattern": 1}, {"pattern": 0}]},
                {"entries": [{"pattern": -1}, {"pattern": 2}, {"pattern": 3}]}]}},
            {"name": "glints", "reference_texture": {"patterns": "leaves", "grid": "cells",
                "index": {"block": "seen"}}},
            {"name": "all", "layers": {"textures": ["mask", "fallen"]}},
            {"name": "moving", "layers": {"textures": ["ground", "flowers", "lights"]}}]}})";
    }

  private:
    void write(const char* name, std::int32_t side, std::int32_t count) {
        std::filesystem::create_directories(folder());
        StraightRgba8Image image{side * count, side, {}};
        for (std::int64_t i = 0; i < std::int64_t{image.width} * image.height; ++i)
            for (std::int64_t c = 0; c < 4; ++c) {
                const std::uint64_t code = hash(9, stream(name), i, c) & 255;
                const bool opaque = std::string{name} == "tiles.png" && c == 3;
                image.bytes.push_back(static_cast<std::uint8_t>(opaque ? 255 : code));
            }
        if (!write_rgba_png(folder() / name, image)) throw std::runtime_error{"cannot write an image"};
    }

    tests::TemporaryFolder folder_;
};

/// Bytes of a page, as `accuracy` gives them.
inline std::vector<std::uint8_t> page_bytes(const Scene& scene, PageKey key,
                                            Accuracy accuracy = Accuracy::high, std::int32_t gutter = 0,
                                            std::int64_t step = 0, std::int32_t parameter = 0) {
    Rgba8Image out;
    TexelRegion region = region_of(key, gutter);
    region.step = step;
    region.parameter = parameter;
    scene.texture->evaluate(region, {.accuracy = accuracy}, out).value();
    return out.bytes;
}

}  // namespace tessera
