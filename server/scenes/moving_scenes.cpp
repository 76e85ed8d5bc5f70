#include "server/scenes/moving_scenes.h"

#include <limits>
#include <string>
#include <utility>

#include "server/scene/png_file.h"
#include "server/scenes/moving_blocks.h"
#include "server/scenes/patterns/canvas.h"
#include "server/scenes/patterns/leaf.h"
#include "server/scenes/patterns/lettering.h"
#include "server/scenes/patterns/lights.h"
#include "shared/math/hash.h"

namespace tessera {

namespace moving {

using painting::sheet_of;

proto::Block& add(proto::Scene& scene, const std::string& name) {
    proto::Block& block = *scene.mutable_pattern()->add_blocks();
    block.set_name(name);
    return block;
}

proto::Block& block_named(proto::Scene& scene, const std::string& name) {
    proto::Pattern& pattern = *scene.mutable_pattern();
    for (int i = 0; i < pattern.blocks_size(); ++i)
        if (pattern.blocks(i).name() == name) return *pattern.mutable_blocks(i);
    return add(scene, name);
}

void add_patterns(PaintedScene& painted, const std::string& name, const std::vector<Rgba8Image>& patterns) {
    const Rgba8Image sheet = sheet_of(patterns, static_cast<std::int32_t>(patterns.size()));
    painted.files.push_back(
        {name + ".png", to_png(sheet.width, sheet.height, PngColor::rgba, 8, sheet.bytes)});
    proto::PatternSet& set = *add(painted.scene, name).mutable_pattern_set();
    set.set_image(name + ".png");
    set.set_side_texels(static_cast<std::uint32_t>(sheet.height));
    set.set_count(static_cast<std::uint32_t>(patterns.size()));
}

void add_frames(proto::Scene& scene, const std::vector<std::pair<std::int32_t, std::uint32_t>>& frames) {
    proto::AnimationSequence& sequence = *add(scene, "frames").mutable_animation_sequence();
    for (const auto& [pattern, steps] : frames) {
        proto::AnimationSequence::Frame& frame = *sequence.add_frames();
        frame.set_pattern(pattern);
        if (steps != 1) frame.set_steps(steps);
    }
}

}  // namespace moving

namespace {

using namespace painting;
using namespace moving;

/// Random phases, fine enough for any cycle.
void add_phases(proto::Scene& scene) {
    proto::VirtualIndirectionMap& phase = *add(scene, "phase").mutable_virtual_indirection_map();
    phase.set_grid("cells");
    phase.set_count(65536);
}

/// How an LED of the board is used by the two messages: what its place in the map stands for.
constexpr std::int32_t strokes = 3;  ///< None, inside, rim: of each message, so nine codes; …
constexpr std::int32_t noises = 7;   ///< … then LEDs of the background that light up now and then.
constexpr std::int32_t board_width = 12288, board_height = 1536;
constexpr std::int32_t leds_a_step = 8;  ///< That it runs to the left.

/// Rests of all codes under one message (0 or 1), in steps; −1: for ever.
void add_rests(proto::Scene& scene, const std::string& name, int message) {
    constexpr std::int32_t rest_of_stroke[strokes] = {-1, 4, 30};
    proto::ProbabilityMap& rests = *add(scene, name).mutable_probability_map();
    rests.mutable_index()->set_block("board");
    for (std::int32_t code = 0; code < strokes * strokes + noises; ++code) {
        std::int32_t rest = 0;
        if (code < strokes * strokes)
            rest = rest_of_stroke[message == 0 ? code / strokes : code % strokes];
        else
            rest = 1500 + 900 * (code - strokes * strokes);
        rests.mutable_material()->add_entries()->set_pattern(rest);
    }
}

PaintedFile paint_board() {
    Board first{board_width, board_height, {}}, second = first;
    first.codes.resize(std::size_t{board_width} * board_height);
    second.codes.resize(first.codes.size());
    write_text(first, "TESSERA", 190, 1, 2);
    write_text(second, "EXACT AT EVERY LEVEL", 100, 1, 2);
    std::vector<std::uint8_t> codes(first.codes.size());
    for (std::size_t i = 0; i < codes.size(); ++i) {
        codes[i] = static_cast<std::uint8_t>(first.codes[i] * strokes + second.codes[i]);
        const std::uint64_t bits = hash(7, stream("noise"), static_cast<std::int64_t>(i), 0);
        if (codes[i] == 0 && bits % 96 == 0)
            codes[i] = static_cast<std::uint8_t>(
                strokes * strokes + static_cast<std::int32_t>(bits >> 32 & 0xffff) * noises / 65536);
    }
    return {"board.png", to_png(board_width, board_height, PngColor::grey, 8, codes)};
}

/// "A LED message board with blinking LEDs" (figure 21 c): what is written runs to the left; two messages
/// change by temporal transition while the density of animation goes down and up again. Once round the board
/// it begins again.
PaintedScene paint_message_board() {
    PaintedScene painted;
    proto::Scene& scene = painted.scene;
    scene.set_extent_log2_pages(10);
    std::vector<Rgba8Image> leds;
    for (const double lit : {0.0, 0.3, 0.65, 1.0}) leds.push_back(paint_led(lit, 16));
    add_patterns(painted, "leds", leds);
    painted.files.push_back(paint_board());
    add(scene, "cells").mutable_virtual_tile_map()->set_cell_texels(16);
    add_frames(scene, {{0, 1}, {1, 1}, {2, 1}, {3, 24}, {2, 1}, {1, 1}});
    add_phases(scene);
    proto::ExplicitMap& board = *add(scene, "board").mutable_explicit_indirection_map();
    board.set_grid("cells");
    board.set_image("board.png");
    board.set_edge(proto::ExplicitMap::wrap);
    board.set_x(2048);
    board.set_y(7424);
    add_rests(scene, "first", 0);
    add_rests(scene, "second", 1);
    proto::AnimationMap& lit = *add(scene, "lit").mutable_animation_map();
    lit.set_sequence("frames");
    lit.mutable_phase()->set_block("phase");
    lit.mutable_rest()->set_block("first");
    const auto change = [&](std::int64_t step, double density, const char* rest = nullptr) {
        proto::AnimationMap::Change& to = *lit.add_changes();
        to.set_step(step);
        to.set_density(density);
        if (rest != nullptr) to.mutable_rest()->set_block(rest);
    };
    constexpr double blank = std::numeric_limits<double>::infinity();
    constexpr std::int64_t shown = 320, fades = 48;
    std::int64_t step = shown;
    for (const char* next : {"second", "first"}) {
        for (const double density : {8.0, 40.0, blank}) change(step, density), step += fades;
        change(step, 40, next), step += fades;
        for (const double density : {8.0, 1.0}) change(step, density), step += fades;
        step += shown;
    }
    block_named(scene, "lit").add_editable("animation");
    block_named(scene, "board").add_editable("map");
    proto::ReferenceTexture& texture = *add(scene, "message-board").mutable_reference_texture();
    texture.set_patterns("leds");
    texture.set_grid("cells");
    texture.mutable_index()->set_block("lit");
    texture.mutable_scroll()->set_cells(leds_a_step);
    static_assert(3 * shown + 12 * fades == board_width / leds_a_step);
    scene.mutable_clock()->set_steps_per_second(20);
    scene.mutable_clock()->set_loop_steps(step);
    return painted;
}

/// Blinking over content exchange: the prepared pebbles by night.
PaintedScene paint_fireflies() {
    PaintedScene painted;
    painted.on_pebbles = true;
    proto::Scene& scene = painted.scene;
    proto::Exchange& pebbles = *add(scene, "pebbles").mutable_content_exchange();
    pebbles.set_asset("asset");
    pebbles.set_seed(1);
    proto::Color& dusk = *add(scene, "dusk").mutable_constant();
    dusk.set_red(8);
    dusk.set_green(14);
    dusk.set_blue(34);
    dusk.set_alpha(205);
    std::vector<Rgba8Image> glows;
    for (const double lit : {0.15, 0.4, 0.7, 1.0}) glows.push_back(paint_glow(lit, 64));
    add_patterns(painted, "glows", glows);
    add(scene, "cells").mutable_virtual_tile_map()->set_cell_texels(128);
    add_frames(scene, {{-1, 1}, {0, 2}, {1, 2}, {2, 2}, {3, 5}, {2, 2}, {1, 3}, {0, 4}});
    add_phases(scene);
    proto::VirtualRandomMap& rest = *add(scene, "rest").mutable_virtual_random_map();
    rest.set_grid("cells");
    rest.set_from(10);
    rest.set_to(110);
    proto::AnimationMap& lit = *add(scene, "lit").mutable_animation_map();
    lit.set_sequence("frames");
    lit.mutable_phase()->set_block("phase");
    lit.mutable_rest()->set_block("rest");
    for (const std::string axis : {"x", "y"}) {
        proto::VirtualRandomMap& at = *add(scene, "at-" + axis).mutable_virtual_random_map();
        at.set_grid("cells");
    }
    proto::TileTransform& place = *add(scene, "place").mutable_tile_transform();
    place.set_grid("cells");
    place.mutable_x()->set_block("at-x");
    place.mutable_y()->set_block("at-y");
    proto::ReferenceTexture& texture = *add(scene, "sparks").mutable_reference_texture();
    texture.set_patterns("glows");
    texture.set_grid("cells");
    texture.mutable_index()->set_block("lit");
    texture.set_transform("place");
    proto::Layers& layers = *add(scene, "night").mutable_layers();
    for (const char* layer : {"pebbles", "dusk", "sparks"}) layers.add_textures(layer);
    block_named(scene, "lit").add_editable("animation");
    scene.mutable_pattern()->set_seed(3);
    scene.mutable_clock()->set_steps_per_second(12);
    return painted;
}

/// Sprites over content exchange (section 3.2, explicit positioning): leaves that fell on the pebbles round
/// the middle of the texture, and some that the wind still drags to and fro.
PaintedScene paint_windfall() {
    PaintedScene painted;
    proto::Scene& scene = painted.scene;
    painted.on_pebbles = true;
    scene.mutable_content_exchange()->set_asset("asset");
    constexpr std::int32_t side = 128;
    using enum Leaf::Kind;
    const LinearColor yellow{0.62, 0.36, 0.04}, red{0.42, 0.07, 0.02}, brown{0.20, 0.10, 0.04},
        green{0.20, 0.26, 0.05};
    const std::vector<Leaf> kinds{
        {maple, red, yellow, brown, 0.2, 0.5, 1},     {oak, brown, yellow, red, 0.3, 0.6, 2},
        {birch, yellow, green, brown, 0.3, 0.4, 3},   {beech, brown, red, yellow, 0.3, 0.5, 4},
        {ginkgo, yellow, yellow, green, 0.2, 0.3, 5}, {willow, green, yellow, brown, 0.4, 0.5, 6}};
    const Rgba8Image sheet = sheet_of(paint_all(static_cast<std::int32_t>(kinds.size()),
                                                [&](std::int32_t i) {
                                                    Rgba8Image leaf =
                                                        paint_leaf(kinds[static_cast<std::size_t>(i)], side);
                                                    add_contact_shade(leaf, 3, 0.5);
                                                    return leaf;
                                                }),
                                      static_cast<std::int32_t>(kinds.size()));
    painted.files.push_back(
        {"leaves.png", to_png(sheet.width, sheet.height, PngColor::rgba, 8, sheet.bytes)});
    proto::Sprites& sprites = *scene.mutable_sprites();
    sprites.mutable_patterns()->set_image("leaves.png");
    sprites.mutable_patterns()->set_side_texels(side);
    constexpr std::int64_t middle = std::int64_t{1} << 27, reach = 1400;
    constexpr std::uint64_t leaves = 160, in_the_wind = 24;
    for (std::uint64_t id = 1; id <= leaves; ++id) {
        const auto draw = [&](const char* what) {
            return static_cast<double>(hash(11, stream(what), static_cast<std::int64_t>(id), 0) >> 40) /
                   0x1p24;
        };
        const auto place = [&](const char* what) {
            // Denser towards the middle
            const double t = draw(what) * 2 - 1;
            return static_cast<double>(middle) + static_cast<double>(reach) * t * (0.3 + 0.7 * t * t);
        };
        proto::SpritePlacement& leaf = *sprites.add_placed();
        leaf.set_id(id);
        leaf.set_pattern(static_cast<std::uint32_t>(draw("kind") * static_cast<double>(kinds.size())));
        leaf.set_x(place("x"));
        leaf.set_y(place("y"));
        leaf.set_scale(0.4 + 0.5 * draw("scale"));
        leaf.set_turn(draw("turn"));
        if (id > in_the_wind) continue;
        proto::SpritePath& path = *leaf.mutable_path();
        path.set_to_x(leaf.x() + 60 + 240 * draw("gust"));
        path.set_to_y(leaf.y() + 120 * draw("lull") - 60);
        path.set_steps(static_cast<std::uint32_t>(30 + 40 * draw("time")));
        path.set_then(proto::SpritePath::reverse);
    }
    scene.mutable_clock()->set_steps_per_second(12);
    return painted;
}

constexpr std::pair<std::string_view, PaintedScene (*)()> painters[] = {
    {"message-board", paint_message_board}, {"fireflies", paint_fireflies},
    {"windfall", paint_windfall},           {"flower-field", moving::paint_flower_field},
    {"road", moving::paint_road},
};

}  // namespace

const std::vector<std::string_view>& moving_scene_names() {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> all;
        for (const auto& [name, paint] : painters) all.push_back(name);
        return all;
    }();
    return names;
}

PaintedScene paint_moving_scene(std::string_view name) {
    for (const auto& [known, paint] : painters)
        if (known == name) return paint();
    return {};
}

}  // namespace tessera
