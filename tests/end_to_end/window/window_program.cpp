#include "tests/end_to_end/window/window_program.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <png.h>

#include "proto/editables.pb.h"
#include "proto/sprite.pb.h"

#include "shared/wire/json.h"
#include "tests/end_to_end/server/raw_client.h"

namespace tessera::test {

namespace {

/// Four patterns of 8 texels, one colour each.
void write_leaves(const std::filesystem::path& file) {
    std::vector<std::uint8_t> texels;
    for (int i = 0; i < 8 * 32; ++i)
        for (const int c : {80 + i % 32 / 8 * 50, 120, 200 - i % 32 / 8 * 40, 255})
            texels.push_back(static_cast<std::uint8_t>(c));
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = 32;
    image.height = 8;
    image.format = PNG_FORMAT_RGBA;
    png_image_write_to_file(&image, file.c_str(), 0, texels.data(), 0, nullptr);
}

/// All that can be edited: a map, an animation, a target, sprites.
std::string scene_json() {
    std::string zeros = "0";
    for (int i = 1; i < 32 * 32; ++i) zeros += ",0";
    return R"({"extent_log2_pages": 6, "targets": [{"id": 1, "x": 750, "y": 740}],
        "sprites": {"patterns": {"image": "leaves.png", "side_texels": 8}},
        "pattern": {"output": "everything", "blocks": [
        {"name": "cells", "virtual_tile_map": {"cell_texels": 8}},
        {"name": "leaves", "pattern_set": {"image": "leaves.png", "side_texels": 8}},
        {"name": "kinds", "editable": ["map"], "areas_map": {"grid": "cells", "cells": 4, "edge": "clamp",
            "x": 16, "y": 16, "width": 32, "values": [)" +
           zeros + R"(]}},
        {"name": "choice", "materials_map": {"material": {"block": "kinds"}, "index": {"block": "phase"},
            "materials": [{"entries": [{"pattern": 0}]}, {"entries": [{"pattern": 1}]}]}},
        {"name": "ground", "reference_texture": {"patterns": "leaves", "grid": "cells", "index": {"block": "choice"}}},
        {"name": "frames", "animation_sequence": {"frames": [{"pattern": -1}, {"pattern": 1},
            {"pattern": 2, "steps": 2}]}},
        {"name": "phase", "virtual_indirection_map": {"grid": "cells", "count": 8, "generator": "independent"}},
        {"name": "blink", "editable": ["animation"], "animation_map": {"sequence": "frames",
            "phase": {"block": "phase"}, "rest": {"integer": 200}}},
        {"name": "lights", "reference_texture": {"patterns": "leaves", "grid": "cells", "index": {"block": "blink"}}},
        {"name": "open", "animation_map": {"sequence": "frames",
            "target_distance": {"near_texels": 8, "far_texels": 64}}},
        {"name": "flowers", "reference_texture": {"patterns": "leaves", "grid": "cells", "index": {"block": "open"}}},
        {"name": "everything", "layers": {"textures": ["ground", "flowers", "lights"]}}]}})";
}

}  // namespace

WindowOnMeadow::WindowOnMeadow() {
    const std::filesystem::path scene = files.path / "meadow";
    std::filesystem::create_directories(scene);
    write_leaves(scene / "leaves.png");
    std::ofstream{scene / "scene.json"} << scene_json();
    server = std::make_unique<testing::Program>(
        std::vector<std::string>{TESSERA_PROGRAM, "serve", "--scenes", files.path.string(), "--keep-no-edits",
                                 "--listen", "127.0.0.1:0"});
    const std::string line = server->first_line();
    port_ = static_cast<std::uint16_t>(std::atoi(line.c_str() + line.rfind(':') + 1));

    looks = {.ground = {static_cast<std::int64_t>(middle), static_cast<std::int64_t>(middle)},
             .pitch_degrees = -90};
    looks.height_texels = height / 8.0 / std::tan(looks.field_of_view_degrees * std::numbers::pi / 360);
    std::ofstream{files.path / "path.json"}
        << R"({"keys": [{"time": 0, "x": 720, "y": 720, "yaw": 0, "pitch": -90, "height": )"
        << std::to_string(looks.height_texels) << "}]}";
}

void WindowOnMeadow::open(const std::vector<std::string>& more, int dots_per_inch, const std::string& size) {
    viewer.reset();
    screen.reset();
    screen = std::make_unique<XScreen>(1280, 1024, dots_per_inch);
    std::vector<std::string> command{VIEW_PROGRAM,
                                     "http://127.0.0.1:" + std::to_string(port_),
                                     "meadow",
                                     "--size",
                                     size,
                                     "--camera",
                                     (files.path / "path.json").string(),
                                     "-o",
                                     (files.path / "out").string()};
    command.insert(command.end(), {"--view", std::string{name_of(surface.kind)}});
    command.insert(command.end(), more.begin(), more.end());
    viewer = std::make_unique<testing::Program>(command);
    ASSERT_TRUE(screen->wait_for_window("Tessera")) << viewer->end().error;
    screen->move(width / 2, 10);
    ASSERT_TRUE(until([&] { return screen->title().find("fps") != std::string::npos; })) << "it draws";
}

WindowOnMeadow::Pixel WindowOnMeadow::pixel_of(double texel_x, double texel_y) const {
    const PlaneView view{looks, width, height, around(surface, looks)};
    const auto at = HandPicture{view}.pixel_of({static_cast<std::int64_t>(texel_x * sprite_units),
                                                static_cast<std::int64_t>(texel_y * sprite_units)});
    return {at->x, at->y};
}

void WindowOnMeadow::click(double texel_x, double texel_y) {
    const Pixel at = pixel_of(texel_x, texel_y);
    screen->click(at.x, at.y);
}

void WindowOnMeadow::drag(double x0, double y0, double x1, double y1) {
    const Pixel from = pixel_of(x0, y0), to = pixel_of(x1, y1);
    screen->drag(from.x, from.y, to.x, to.y);
}

std::vector<WindowOnMeadow::Pixel> WindowOnMeadow::runs_of(std::uint32_t colour, int least_pixels) const {
    const XScreen::Picture picture = screen->picture();
    for (int y = picture.height - 1; y >= 0; --y) {
        std::vector<Pixel> runs;
        for (int x = 0, begin = 0; x < picture.width; ++x) {
            if (picture.at(x, y) != colour) begin = x + 1;
            const bool is_end = x + 1 == picture.width || picture.at(x + 1, y) != colour;
            if (is_end && x + 1 - begin >= least_pixels)
                runs.push_back({(begin + x) / 2.0, static_cast<double>(y)});
        }
        if (!runs.empty()) return runs;
    }
    return {};
}

std::string WindowOnMeadow::get(const std::string& target) const {
    RawClient client{port_};
    client.send("GET /scenes/meadow" + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const auto reply = client.receive();
    return reply && reply->status == 200 ? reply->body : std::string{};
}

std::uint64_t WindowOnMeadow::revision() const { return sprites().revision(); }

proto::SpriteList WindowOnMeadow::sprites() const {
    proto::SpriteList list;
    EXPECT_TRUE(read_json_leniently(get("/sprites?x0=0&y0=0&x1=16384&y1=16384"), "sprites", list));
    return list;
}

proto::SceneEditables WindowOnMeadow::editables() const {
    proto::SceneEditables editables;
    EXPECT_TRUE(read_json_leniently(get("/editables"), "editables", editables));
    return editables;
}

std::string WindowOnMeadow::page() const { return get("/6/2/2.rgba?step=0"); }

double WindowOnMeadow::camera(const std::string& what) {
    screen->tap('k');
    const std::string key = viewer->line_after("{\"time\"");
    const std::size_t at = key.find("\"" + what + "\"");
    EXPECT_NE(at, std::string::npos) << key;
    return at == std::string::npos
               ? 0
               : std::atof(key.c_str() + key.find_first_of("-0123456789", at + what.size() + 2));
}

void WindowOnMeadow::let_frames_pass() {
    camera("yaw");
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
    camera("yaw");
}

bool WindowOnMeadow::until(const std::function<bool()>& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{30};
    while (!holds()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds{30});
    }
    return true;
}

}  // namespace tessera::test
