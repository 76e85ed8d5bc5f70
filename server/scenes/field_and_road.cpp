#include <array>

#include "server/scene/png_file.h"
#include "server/scenes/moving_blocks.h"
#include "server/scenes/patterns/canvas.h"
#include "server/scenes/patterns/flowers.h"
#include "server/scenes/patterns/litter.h"
#include "server/scenes/patterns/meadow.h"
#include "server/scenes/patterns/road.h"
#include "shared/math/hash.h"

namespace tessera::moving {

using namespace painting;

namespace {

void add_grid(proto::Scene& scene, const std::string& name, std::uint32_t side) {
    add(scene, name).mutable_virtual_tile_map()->set_cell_texels(side);
}

void add_draw(proto::Scene& scene, const std::string& name, const std::string& grid, std::size_t count) {
    proto::VirtualIndirectionMap& draw = *add(scene, name).mutable_virtual_indirection_map();
    draw.set_grid(grid);
    draw.set_count(static_cast<std::uint32_t>(count));
}

/// Tiles in no order, as a texture called `name`.
void add_tiles(PaintedScene& painted, const std::string& name, const std::vector<Rgba8Image>& tiles) {
    add_patterns(painted, name + "-tiles", tiles);
    add_draw(painted.scene, "which-" + name, "ground-cells", tiles.size());
    proto::ReferenceTexture& texture = *add(painted.scene, name).mutable_reference_texture();
    texture.set_patterns(name + "-tiles");
    texture.set_grid("ground-cells");
    texture.mutable_index()->set_block("which-" + name);
}

/// The middle of an extent of 2^10 pages.
constexpr std::int64_t middle = std::int64_t{1} << 17;

}  // namespace

/// "The flowers open when the small balls are close to them" (figure 21 a). The balls are sprites that go to
/// and fro on the targets' legs.
PaintedScene paint_flower_field() {
    PaintedScene painted;
    proto::Scene& scene = painted.scene;
    scene.set_extent_log2_pages(10);
    scene.mutable_pattern()->set_seed(5);
    add_grid(scene, "ground-cells", 128);
    add_tiles(painted, "lawn", paint_all(lawn_tiles, [](std::int32_t i) { return paint_lawn(i, 128); }));

    constexpr std::int32_t states = 6, side = 64;
    std::vector<Rgba8Image> flowers = paint_all(flower_kinds * states, [](std::int32_t i) {
        return paint_flower(i / states, (i % states) / (states - 1.0), side);
    });
    add_patterns(painted, "flowers", flowers);
    add_grid(scene, "cells", 64);
    std::vector<std::pair<std::int32_t, std::uint32_t>> frames;
    for (std::int32_t state = 0; state < states; ++state) frames.emplace_back(state, 1);
    add_frames(scene, frames);
    proto::Block& open = add(scene, "open");
    open.mutable_animation_map()->set_sequence("frames");
    proto::TargetDistance& near = *open.mutable_animation_map()->mutable_target_distance();
    near.set_near_texels(110);
    near.set_far_texels(560);
    open.add_editable("target_distance.near_texels");
    open.add_editable("target_distance.far_texels");
    add_draw(scene, "kind-draw", "cells", 8);
    proto::ProbabilityMap& kind = *add(scene, "kind").mutable_probability_map();
    kind.mutable_index()->set_block("kind-draw");
    for (const std::int32_t of : {0, 0, 0, 1, 1, 2, 3, 3})
        kind.mutable_material()->add_entries()->set_pattern(of);
    proto::MaterialsMap& flower = *add(scene, "flower").mutable_materials_map();
    flower.mutable_material()->set_block("kind");
    flower.mutable_index()->set_block("open");
    for (std::int32_t of = 0; of <= flower_kinds; ++of) {
        proto::Material& material = *flower.add_materials();
        for (std::int32_t state = 0; state < states; ++state)
            material.add_entries()->set_pattern(of < flower_kinds ? of * states + state : -1);
    }
    const auto number = [&](const std::string& name, double from, double to) {
        proto::VirtualRandomMap& random = *add(scene, name).mutable_virtual_random_map();
        random.set_grid("cells");
        random.set_from(from);
        random.set_to(to);
    };
    number("at-x", 0, 1);
    number("at-y", 0, 1);
    number("scale", 0.40, 0.54);
    number("turn", 0, 255.0 / 256);
    proto::TileTransform& place = *add(scene, "place").mutable_tile_transform();
    place.set_grid("cells");
    place.mutable_x()->set_block("at-x");
    place.mutable_y()->set_block("at-y");
    place.mutable_scale()->set_block("scale");
    place.mutable_turn()->set_block("turn");
    place.set_turns(8);
    place.set_scales(2);
    proto::ReferenceTexture& texture = *add(scene, "field").mutable_reference_texture();
    texture.set_patterns("flowers");
    texture.set_grid("cells");
    texture.mutable_index()->set_block("flower");
    texture.set_transform("place");
    proto::Layers& layers = *add(scene, "all").mutable_layers();
    for (const char* layer : {"lawn", "field"}) layers.add_textures(layer);

    constexpr std::int32_t balls = 3, ball_side = 128;
    constexpr std::uint32_t steps = 240;
    const Rgba8Image sheet =
        sheet_of(paint_all(balls, [](std::int32_t i) { return paint_ball(i, ball_side); }), balls);
    painted.files.push_back({"balls.png", to_png(sheet.width, sheet.height, PngColor::rgba, 8, sheet.bytes)});
    scene.mutable_sprites()->mutable_patterns()->set_image("balls.png");
    scene.mutable_sprites()->mutable_patterns()->set_side_texels(ball_side);
    struct Line {
        std::int64_t from_x, from_y, to_x, to_y;
    };
    constexpr std::array<Line, balls> lines{
        {{-1500, -420, 1400, -700}, {-900, 900, 1100, 40}, {200, -1300, -250, 1400}}};
    for (std::int32_t i = 0; i < balls; ++i) {
        const auto [from_x, from_y, to_x, to_y] = lines[static_cast<std::size_t>(i)];
        proto::Target& target = *scene.add_targets();
        target.set_id(static_cast<std::uint64_t>(i) + 1);
        target.set_x(middle + from_x);
        target.set_y(middle + from_y);
        proto::Target::Leg& leg = *target.add_legs();
        leg.set_x(middle + to_x);
        leg.set_y(middle + to_y);
        leg.set_steps(steps);
        target.set_return_steps(steps);
        proto::SpritePlacement& ball = *scene.mutable_sprites()->add_placed();
        ball.set_id(static_cast<std::uint64_t>(i) + 1);
        ball.set_pattern(static_cast<std::uint32_t>(i));
        ball.set_x(static_cast<double>(target.x()));
        ball.set_y(static_cast<double>(target.y()));
        ball.mutable_path()->set_to_x(static_cast<double>(leg.x()));
        ball.mutable_path()->set_to_y(static_cast<double>(leg.y()));
        ball.mutable_path()->set_steps(steps);
        ball.mutable_path()->set_then(proto::SpritePath::reverse);
    }
    scene.mutable_clock()->set_steps_per_second(20);
    scene.mutable_clock()->set_loop_steps(2 * steps);
    return painted;
}

/// Explicit positioning (section 3.2, figure 6): plates and arrows put on a road by hand, footprints that
/// come in a walk and fade away again, and lamps that blink.
PaintedScene paint_road() {
    PaintedScene painted;
    proto::Scene& scene = painted.scene;
    scene.set_extent_log2_pages(10);
    scene.mutable_pattern()->set_seed(8);
    add_grid(scene, "ground-cells", 64);
    add_tiles(painted, "meadow",
              paint_all(meadow_tiles, [](std::int32_t i) { return paint_meadow_tile(i, 64); }));
    add_tiles(painted, "asphalt",
              paint_all(asphalt_tiles, [](std::int32_t i) { return paint_asphalt(i, 64); }));
    proto::Color& white = *add(scene, "paint").mutable_constant();
    white.set_red(214);
    white.set_green(214);
    white.set_blue(208);
    constexpr std::int32_t map_side = 2048, entry_texels = 4;
    painted.files.push_back(
        {"road.png", to_png(map_side, map_side, PngColor::grey, 8, paint_road_map(map_side))});
    proto::PixelMap& map = *add(scene, "ground").mutable_pixel_map();
    map.set_image("road.png");
    map.set_texels(entry_texels);
    for (const char* family : {"meadow", "asphalt", "paint"}) map.add_textures(family);

    constexpr std::int32_t side = 128;
    const Rgba8Image sheet =
        sheet_of(paint_all(road_things,
                           [](std::int32_t i) { return paint_road_thing(static_cast<RoadThing>(i), side); }),
                 road_things);
    painted.files.push_back(
        {"things.png", to_png(sheet.width, sheet.height, PngColor::rgba, 8, sheet.bytes)});
    proto::Sprites& sprites = *scene.mutable_sprites();
    sprites.mutable_patterns()->set_image("things.png");
    sprites.mutable_patterns()->set_side_texels(side);
    proto::SpriteAnimation& blinks = *sprites.add_animations();
    for (const auto& [thing, steps] : {std::pair{RoadThing::lamp_out, 9u}, {RoadThing::lamp_lit, 3u}}) {
        proto::SpriteAnimation::Frame& frame = *blinks.add_frames();
        frame.set_pattern(static_cast<std::uint32_t>(thing));
        frame.set_steps(steps);
    }
    std::uint64_t last = 0;
    const auto put = [&](RoadThing thing, std::int64_t x, std::int64_t y, double scale, double turn,
                         std::int32_t order) -> proto::SpritePlacement& {
        proto::SpritePlacement& sprite = *sprites.add_placed();
        sprite.set_id(++last);
        sprite.set_pattern(static_cast<std::uint32_t>(thing));
        sprite.set_x(static_cast<double>(middle + x));
        sprite.set_y(static_cast<double>(middle + y));
        sprite.set_scale(scale);
        sprite.set_turn(turn);
        sprite.set_order(order);
        return sprite;
    };
    for (std::int64_t x = -1800; x <= 1800; x += 900) {
        put(RoadThing::arrow, x, 165, 1.1, 0.25, 0);
        put(RoadThing::arrow, x + 450, -165, 1.1, 0.75, 0);
    }
    put(RoadThing::no_entry, -620, -470, 1.3, 0, 3);
    put(RoadThing::warning, 560, 480, 1.3, 0, 3);
    put(RoadThing::warning, -1500, 470, 1.1, 0, 3);
    for (std::int64_t i = 0; i < 8; ++i) {
        // Four round each of two works, one after the other
        proto::SpritePlacement& lamp = put(RoadThing::lamp_out, (i < 4 ? 250 : -1100) + (i % 2) * 300,
                                           230 + (i / 2 % 2) * 110, 0.6, 0, 4);
        lamp.set_animation(0);
        lamp.set_phase(3 * (i % 4));
    }
    // Somebody walks over the road; who crosses later walks back
    constexpr std::int64_t steps_apart = 5, lives = 300, feet = 44, stride = 46;
    for (std::int64_t walk = 0; walk < 2; ++walk)
        for (std::int64_t i = 0; i < feet; ++i) {
            const std::int64_t along = (i - feet / 2) * stride, aside = i % 2 == 0 ? -20 : 20;
            const double swing = static_cast<double>(hash(21, stream("foot"), walk, i) >> 40) / 0x1p24 - 0.5;
            const bool left = i % 2 == 0;
            // Up the picture, a little to the right; then down it
            const std::int64_t x = walk == 0 ? along / 4 + aside - 150 : 420 - aside - along / 3;
            const std::int64_t y = walk == 0 ? -along : along;
            proto::SpritePlacement& foot = put(left ? RoadThing::left_foot : RoadThing::right_foot, x, y, 0.5,
                                               (walk == 0 ? 0.04 : 0.55) + 0.02 * (swing + 0.5), 1);
            const std::int64_t begin = 10 + walk * 260 + i * steps_apart;
            foot.set_first_step(begin);
            foot.set_end_step(begin + lives);
        }
    scene.mutable_clock()->set_steps_per_second(12);
    scene.mutable_clock()->set_loop_steps(10 + 260 + feet * steps_apart + lives + 10);
    return painted;
}

}  // namespace tessera::moving
