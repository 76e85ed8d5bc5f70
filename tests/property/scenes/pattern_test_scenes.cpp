#include "tests/property/scenes/pattern_test_scenes.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <memory>

#include <gtest/gtest.h>

#include "server/prepare/recorded.h"
#include "server/scene/asset_file.h"
#include "server/scene/image_file.h"
#include "server/scenes/moving_scenes.h"
#include "server/scenes/paint_pebbles.h"
#include "server/scenes/painted_folder.h"
#include "server/scenes/pattern_scenes.h"
#include "shared/math/hash.h"

namespace tessera::tests {
namespace {

namespace fs = std::filesystem;

/// Patterns of high contrast in one row, so that whatever bleeds or is left out shows. `see_through`: with a
/// transparent rim and holes.
void write_patterns(const fs::path& file, std::int32_t side, std::int32_t count, bool see_through) {
    StraightRgba8Image image{side * count, side, {}};
    image.bytes.resize(std::size_t(image.width) * std::size_t(side) * 4);
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < image.width; ++x) {
            const std::int32_t pattern = x / side;
            const std::uint64_t bits =
                hash(77, stream("test pattern", std::uint64_t(pattern)), (x % side) / 2, y / 2);
            const double u = (x % side + 0.5) / side - 0.5, v = (y + 0.5) / side - 0.5;
            std::uint8_t* texel =
                image.bytes.data() + 4 * (std::size_t(y) * std::size_t(image.width) + std::size_t(x));
            for (int c = 0; c < 3; ++c)
                texel[c] =
                    static_cast<std::uint8_t>((bits >> (8 * c)) % 2 * 200 + (pattern * 53 + c * 90) % 56);
            texel[3] = see_through
                           ? static_cast<std::uint8_t>(u * u + v * v < 0.2 ? (bits >> 40) % 2 * 155 + 100 : 0)
                           : 255;
        }
    const auto written = write_rgba_png(file, image);
    ASSERT_TRUE(written.has_value()) << written.error().detail;
}

void write_map(const fs::path& file, std::int32_t side, std::uint32_t values) {
    LabelImage image{side, side, {}};
    for (std::int32_t y = 0; y < side; ++y)
        for (std::int32_t x = 0; x < side; ++x)
            image.labels.push_back(
                static_cast<std::uint16_t>(hash(78, stream("test map"), x / 2, y / 3) % values));
    const auto written = write_label_png(file, image);
    ASSERT_TRUE(written.has_value()) << written.error().detail;
}

/// A small asset of the painted pebbles, prepared once.
const fs::path& small_pebbles() {
    static const TemporaryFolder folder;
    static const fs::path asset = [] {
        SilentProgress progress;
        const auto prepared =
            prepare_recorded(paint_pebbles(256, 1), {},
                             {.tile_side = 128, .patches = 16, .contents = 4, .blend_texels = 8, .seed = 3},
                             nullptr, progress);
        EXPECT_TRUE(prepared.has_value()) << prepared.error().detail;
        const auto written =
            write_exchange_asset(folder.path / "asset", prepared->asset, prepared->preparation);
        EXPECT_TRUE(written.has_value()) << written.error().detail;
        return folder.path / "asset";
    }();
    return asset;
}

const std::string grid_32 = R"({"name": "cells", "virtual_tile_map": {"cell_texels": 32}})";
const std::string opaque = R"({"name": "set", "pattern_set": {"image": "opaque.png", "side_texels": 32}})";
const std::string clear = R"({"name": "clear", "pattern_set": {"image": "clear.png", "side_texels": 32}})";

std::string pattern(const std::string& blocks) {
    return R"({"extent_log2_pages": 12, "pattern": {"seed": 5, "blocks": [)" + blocks + "]}}";
}

/// Cells of the opaque set, chosen by the block "which" that `blocks` defines.
std::string tiling(const std::string& blocks) {
    return pattern(
        grid_32 + ", " + opaque + ", " + blocks +
        R"(, {"name": "tiles", "reference_texture": {"patterns": "set", "grid": "cells", "index": {"block": "which"}}})");
}

}  // namespace

std::vector<PatternTestScene> pattern_test_scenes() {
    const std::string numbers =
        R"({"name": "x", "virtual_random_map": {"grid": "cells"}}, {"name": "y", "virtual_random_map": {"grid": "cells"}},
           {"name": "turn", "virtual_random_map": {"grid": "cells", "levels": 8, "to": 0.875}},
           {"name": "scale", "virtual_random_map": {"grid": "cells", "from": 0.4, "to": 0.7, "levels": 4}})";
    const auto instances = [&](const std::string& overflow) {
        return R"(, {"name": "place", "tile_transform": {"grid": "cells", "x": {"block": "x"}, "y": {"block": "y"},
                    "turn": {"block": "turn"}, "scale": {"block": "scale"}, "turns": 8, "scales": 2, "overflow": )" +
               overflow +
               R"(}}, {"name": "things", "reference_texture": {"patterns": "clear", "grid": "cells", "index": {"block": "which"}, "transform": "place"}})";
    };
    const std::string which =
        R"({"name": "which", "virtual_indirection_map": {"grid": "cells", "count": 4}})";
    return {
        // The samples
        {.name = "tiles", .is_exact = true},
        {.name = "meadow-sand", .largest_bound = 1.2, .x = 5400, .y = 3300},
        {.name = "leaves", .is_exact = true},
        {.name = "autumn", .largest_bound = 3, .x = 5000, .y = 5000, .side = 8},
        {.name = "terrain", .largest_bound = 2.9, .x = 1069023232, .y = 1065877504},
        {.name = "petals", .largest_bound = 2},
        {.name = "grove", .is_exact = true, .slice = 12},
        // Each generator
        {.name = "typed",
         .json = tiling(
             R"({"name": "which", "virtual_indirection_map": {"grid": "cells", "count": 4, "generator": "typed"}})"),
         .is_exact = true},
        {.name = "independent",
         .json = tiling(
             R"({"name": "which", "virtual_indirection_map": {"grid": "cells", "count": 4, "generator": "independent"}})")},
        {.name = "nested",
         .json = tiling(
             R"({"name": "which", "virtual_indirection_map": {"grid": "cells", "count": 4, "generator": "nested"}})")},
        {.name = "sigma",
         .json = tiling(
             R"({"name": "which", "virtual_indirection_map": {"grid": "cells", "count": 4, "generator": "sigma"}})"),
         .is_exact = true},
        // Maps
        {.name = "explicit-indirection",
         .json = tiling(
             R"({"name": "which", "explicit_indirection_map": {"grid": "cells", "image": "map.png"}})")},
        {.name = "explicit-with-blank-outside",
         .json = tiling(
             R"({"name": "which", "explicit_indirection_map": {"grid": "cells", "values": [0, 1, 2, 3, -1, 2], "width": 3, "cells": 4, "edge": "blank"}})"),
         .x = 200,
         .y = 300},
        {.name = "areas",
         .json = tiling(R"({"name": "area", "areas_map": {"grid": "cells", "image": "map.png", "cells": 8}},
             {"name": "draw", "virtual_indirection_map": {"grid": "cells", "count": 4, "generator": "independent"}},
             {"name": "which", "materials_map": {"material": {"block": "area"}, "index": {"block": "draw"}, "materials": [
               {"entries": [{"pattern": 0}, {"pattern": 1}]}, {"entries": [{"pattern": 2, "weight": 3}, {"pattern": -1}]},
               {"entries": [{"pattern": 3}]}, {"entries": [{"pattern": 0, "weight": 2}, {"pattern": 3, "weight": 2}]}]}})")},
        {.name = "dithered-along-x",
         .json = tiling(
             R"({"name": "which", "dithered_areas_map": {"areas": {"grid": "cells", "image": "map.png", "cells": 8, "edge": "clamp"}, "axes": "x_only"}})"),
         .x = 1000,
         .y = 1000},
        {.name = "dithered-nested",
         .json = tiling(
             R"({"name": "which", "dithered_areas_map": {"areas": {"grid": "cells", "image": "map.png", "cells": 8}, "generator": "nested"}})"),
         .largest_bound = 2.7},
        {.name = "probability",
         .json = tiling(R"({"name": "draw", "virtual_indirection_map": {"grid": "cells", "count": 8}},
             {"name": "which", "probability_map": {"index": {"block": "draw"}, "material": {"entries": [{"pattern": 1, "weight": 5}, {"pattern": 2}, {"pattern": -1, "weight": 2}]}}})"),
         .is_exact = true},
        {.name = "animation",
         .json = tiling(
             R"({"name": "film", "animation_sequence": {"frames": [{"pattern": 0, "steps": 2}, {"pattern": 1}, {"pattern": 3}]}},
             {"name": "phase", "virtual_indirection_map": {"grid": "cells", "count": 16}},
             {"name": "which", "animation_map": {"sequence": "film", "phase": {"block": "phase"}, "rest": {"integer": 3}}})"),
         // What an animation draws is independent: cells that move are summed to 4^5 a texel
         .largest_bound = 2.3},
        {.name = "pixel-map",
         .json = pattern(
             grid_32 + ", " + opaque + ", " + which +
             R"(, {"name": "tiles", "reference_texture": {"patterns": "set", "grid": "cells", "index": {"block": "which"}}},
             {"name": "red", "constant": {"red": 200, "green": 30, "blue": 20}}, {"name": "blue", "constant": {"red": 10, "green": 30, "blue": 220}},
             {"name": "mask", "pixel_map": {"image": "map.png", "textures": ["tiles", "red", "blue", "tiles"], "texels": 4}})"),
         .is_exact = true},
        // Transforms, volumes, layers
        {.name = "instances",
         .json = pattern(grid_32 + ", " + clear + ", " + which + ", " + numbers + instances("false")),
         .is_exact = true},
        {.name = "instances-that-hang-over",
         .json = pattern(grid_32 + ", " + clear + ", " + which + ", " + numbers + instances("true")),
         .largest_bound = 3.3},
        {.name = "slices",
         .json = pattern(R"({"name": "cells", "virtual_tile_map": {"cell_texels": 32, "cell_slices": 4}},
             {"name": "set", "pattern_set": {"image": "opaque.png", "side_texels": 32, "slices": 2}},
             {"name": "which", "virtual_indirection_map": {"grid": "cells", "count": 2}},
             {"name": "tiles", "reference_texture": {"patterns": "set", "grid": "cells", "index": {"block": "which"}}})"),
         .is_exact = true,
         .slice = 5},
        {.name = "layers-of-two-grids",
         .json = pattern(
             grid_32 + R"(, {"name": "fine", "virtual_tile_map": {"cell_texels": 16}},
             {"name": "small", "pattern_set": {"image": "small.png", "side_texels": 16}}, )" +
             opaque + ", " + which +
             R"(, {"name": "tiles", "reference_texture": {"patterns": "set", "grid": "cells", "index": {"block": "which"}}},
             {"name": "dots-which", "virtual_indirection_map": {"grid": "fine", "count": 4}},
             {"name": "dots", "reference_texture": {"patterns": "small", "grid": "fine", "index": {"block": "dots-which"}}},
             {"name": "layers", "layers": {"textures": ["tiles", "dots"]}})"),
         .is_exact = true},
    };
}

WrittenScene::WrittenScene(const PatternTestScene& scene) {
    // Painting takes the longest: once for all tests of a program
    static std::map<std::string, std::unique_ptr<TemporaryFolder>> samples;
    if (scene.json.empty()) {
        auto& home = samples[scene.name];
        if (home == nullptr) {
            home = std::make_unique<TemporaryFolder>();
            const auto written = write_painted_folder(
                home->path / scene.name,
                std::ranges::count(moving_scene_names(), scene.name) > 0 ? paint_moving_scene(scene.name)
                                                                         : paint_pattern_scene(scene.name),
                [](const fs::path& inside) -> Result<void> {
                    fs::copy(small_pebbles(), inside / "asset", fs::copy_options::recursive);
                    return {};
                });
            EXPECT_TRUE(written.has_value()) << written.error().detail;
        }
        folder_ = home->path / scene.name;
        return;
    }
    folder_ = temporary_.path / scene.name;
    fs::create_directory(folder_);
    write_patterns(folder_ / "opaque.png", 32, 4, false);
    write_patterns(folder_ / "clear.png", 32, 4, true);
    write_patterns(folder_ / "small.png", 16, 4, true);
    write_map(folder_ / "map.png", 16, 4);
    std::ofstream{folder_ / "scene.json"} << scene.json;
}

}  // namespace tessera::tests
