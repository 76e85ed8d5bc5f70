#include "server/scenes/pattern_scenes.h"

#include <functional>
#include <utility>

#include "server/scene/png_file.h"
#include "server/scenes/patterns/area_maps.h"
#include "server/scenes/patterns/litter.h"
#include "server/scenes/patterns/meadow.h"
#include "server/scenes/patterns/petals.h"
#include "server/scenes/patterns/shore.h"
#include "server/scenes/patterns/terrain.h"
#include "server/scenes/patterns/trees.h"

namespace tessera {
namespace {

using namespace painting;

PaintedFile sheet_file(std::string name, const std::vector<Rgba8Image>& patterns, std::int32_t columns) {
    const Rgba8Image sheet = sheet_of(patterns, columns);
    return {std::move(name), to_png(sheet.width, sheet.height, PngColor::rgba, 8, sheet.bytes)};
}

PaintedFile map_file(std::string name, std::int32_t side, const std::vector<std::uint8_t>& codes) {
    return {std::move(name), to_png(side, side, PngColor::grey, 8, codes)};
}

/// Writes blocks in the order of their data. Those of one scene share a grid, "cells".
class Blocks {
  public:
    explicit Blocks(proto::Scene& scene) : pattern_{*scene.mutable_pattern()} { pattern_.set_seed(1); }

    proto::Block& add(const std::string& name) {
        proto::Block& block = *pattern_.add_blocks();
        block.set_name(name);
        return block;
    }
    void patterns(const std::string& name, const std::string& image, std::int32_t side, std::size_t count,
                  std::int32_t slices = 1) {
        proto::PatternSet& set = *add(name).mutable_pattern_set();
        set.set_image(image);
        set.set_side_texels(static_cast<std::uint32_t>(side));
        set.set_count(static_cast<std::uint32_t>(count));
        if (slices > 1) set.set_slices(static_cast<std::uint32_t>(slices));
    }
    void cells(std::int32_t side, std::int32_t slices = 0) {
        proto::VirtualTileMap& grid = *add("cells").mutable_virtual_tile_map();
        grid.set_cell_texels(static_cast<std::uint32_t>(side));
        grid.set_cell_slices(static_cast<std::uint32_t>(slices));
    }
    void index(const std::string& name, std::int32_t count,
               proto::Draw::Generator generator = proto::Draw::automatic) {
        proto::VirtualIndirectionMap& index = *add(name).mutable_virtual_indirection_map();
        index.set_grid("cells");
        index.set_count(static_cast<std::uint32_t>(count));
        index.set_generator(generator);
    }
    void number(const std::string& name, double from, double to) {
        proto::VirtualRandomMap& number = *add(name).mutable_virtual_random_map();
        number.set_grid("cells");
        number.set_from(from);
        number.set_to(to);
    }
    struct Room {
        double least_scale = 0.5, most_scale = 0.7;
        std::int32_t turns = 32, scales = 4;
        bool overflow = false;
    };
    /// A place, a scale and a turn for each cell, as `name`; drawn by blocks of that name.
    void transform(const std::string& name, const Room& room) {
        number(name + "-x", 0, 1);
        number(name + "-y", 0, 1);
        number(name + "-scale", room.least_scale, room.most_scale);
        number(name + "-turn", 0, 255.0 / 256);
        proto::TileTransform& transform = *add(name).mutable_tile_transform();
        transform.set_grid("cells");
        transform.mutable_x()->set_block(name + "-x");
        transform.mutable_y()->set_block(name + "-y");
        transform.mutable_scale()->set_block(name + "-scale");
        transform.mutable_turn()->set_block(name + "-turn");
        transform.set_turns(static_cast<std::uint32_t>(room.turns));
        transform.set_scales(static_cast<std::uint32_t>(room.scales));
        transform.set_overflow(room.overflow);
    }
    /// `index` and `transform` may be empty.
    void texture(const std::string& name, const std::string& patterns, const std::string& index,
                 const std::string& transform = {}) {
        proto::ReferenceTexture& texture = *add(name).mutable_reference_texture();
        texture.set_patterns(patterns);
        texture.set_grid("cells");
        if (!index.empty()) texture.mutable_index()->set_block(index);
        texture.set_transform(transform);
    }
    void areas(const std::string& name, const std::string& image, std::uint32_t cells) {
        proto::DitheredAreasMap& areas = *add(name).mutable_dithered_areas_map();
        areas.mutable_areas()->set_grid("cells");
        areas.mutable_areas()->set_image(image);
        areas.mutable_areas()->set_cells(cells);
        pattern_.mutable_blocks()->rbegin()->add_editable("map");
    }
    void layers(const std::vector<std::string>& textures) {
        proto::Layers& layers = *add("layers").mutable_layers();
        for (const std::string& texture : textures) layers.add_textures(texture);
    }

  private:
    proto::Pattern& pattern_;
};

/// Pattern and weight.
using Mixture = std::vector<std::pair<std::int32_t, std::uint32_t>>;

void fill(proto::Material& material, const Mixture& mixture) {
    for (const auto& [pattern, weight] : mixture) {
        proto::Material::Entry& entry = *material.add_entries();
        entry.set_pattern(pattern);
        if (weight != 1) entry.set_weight(weight);
    }
}

/// Basic aperiodic tiling.
PaintedScene paint_tiles() {
    PaintedScene painted;
    painted.files.push_back(sheet_file(
        "meadow.png", paint_all(meadow_tiles, [](std::int32_t i) { return paint_meadow_tile(i, 64); }), 4));
    Blocks blocks{painted.scene};
    blocks.patterns("meadow", "meadow.png", 64, meadow_tiles);
    blocks.cells(64);
    blocks.index("which", meadow_tiles);
    blocks.texture("tiles", "meadow", "which");
    return painted;
}

Corners corners_of(std::int32_t combination, std::int32_t families) {
    Corners corners{};
    for (std::int32_t& corner : corners) {
        corner = combination % families;
        combination /= families;
    }
    return corners;
}

/// Extended aperiodic tiling.
PaintedScene paint_meadow_sand() {
    constexpr std::int32_t plain = 16, of_each_border = 2;
    struct Tile {
        Corners corners;
        std::int32_t variant;
    };
    std::vector<Tile> tiles;
    std::vector<std::pair<Corners, Mixture>> combinations;
    // Of each family: half of it plain, so that what stands there stays rare
    static constexpr std::uint32_t meadow_weights[plain] = {9, 2, 2, 2, 1, 1, 2, 2, 1, 1, 1, 2, 1, 2, 9, 10};
    static constexpr std::uint32_t sand_weights[plain] = {8, 8, 2, 2, 7, 1, 1, 4, 2, 1, 4, 1, 3, 2, 1, 1};
    for (std::int32_t combination = 0; combination < 16; ++combination) {
        const Corners corners = corners_of(combination, 2);
        const bool is_plain = combination == 0 || combination == 15;
        Mixture mixture;
        for (std::int32_t variant = 0; variant < (is_plain ? plain : of_each_border); ++variant) {
            const std::uint32_t weight =
                !is_plain ? 1 : (combination == 0 ? meadow_weights : sand_weights)[variant];
            mixture.emplace_back(static_cast<std::int32_t>(tiles.size()), weight);
            tiles.push_back({corners, variant});
        }
        combinations.emplace_back(corners, std::move(mixture));
    }
    PaintedScene painted;
    painted.files.push_back(sheet_file("tiles.png",
                                       paint_all(static_cast<std::int32_t>(tiles.size()),
                                                 [&](std::int32_t i) {
                                                     const Tile& tile = tiles[static_cast<std::size_t>(i)];
                                                     return paint_shore_tile(tile.corners, tile.variant, 64);
                                                 }),
                                       8));
    constexpr std::int32_t map_side = 32;
    painted.files.push_back(map_file("areas.png", map_side, paint_shore_map(map_side)));
    Blocks blocks{painted.scene};
    blocks.patterns("patterns", "tiles.png", 64, tiles.size());
    blocks.cells(64);
    blocks.areas("areas", "areas.png", 8);
    blocks.index("which", 480, proto::Draw::independent);
    proto::TransitionTiles& transition = *blocks.add("borders").mutable_transition_tiles();
    transition.mutable_material()->set_block("areas");
    transition.mutable_index()->set_block("which");
    transition.set_families(2);
    for (const auto& [corners, mixture] : combinations) {
        auto& combination = *transition.add_combinations();
        for (const std::int32_t corner : corners) combination.add_corners(static_cast<std::uint32_t>(corner));
        fill(*combination.mutable_patterns(), mixture);
    }
    blocks.texture("tiles", "patterns", "borders");
    return painted;
}

/// Basic sparse convolution.
PaintedScene paint_leaves() {
    PaintedScene painted;
    painted.files.push_back(sheet_file(
        "floor.png", paint_all(forest_floor_tiles, [](std::int32_t i) { return paint_forest_floor(i, 128); }),
        4));
    painted.files.push_back(sheet_file("leaf.png", {paint_autumn_leaf(1, 128)}, 1));
    Blocks blocks{painted.scene};
    blocks.patterns("floor-patterns", "floor.png", 128, forest_floor_tiles);
    blocks.patterns("leaf", "leaf.png", 128, 1);
    blocks.cells(128);
    blocks.index("which-floor", forest_floor_tiles);
    blocks.texture("floor", "floor-patterns", "which-floor");
    std::vector<std::string> layers{"floor"};
    for (const std::string layer : {"lower", "middle", "upper"}) {
        blocks.transform(layer, {.least_scale = 0.26, .most_scale = 0.42});
        blocks.texture(layer + "-leaves", "leaf", "", layer);
        layers.push_back(layer + "-leaves");
    }
    blocks.layers(layers);
    return painted;
}

/// Extended sparse convolution.
PaintedScene paint_autumn() {
    PaintedScene painted;
    painted.files.push_back(
        sheet_file("lawn.png", paint_all(lawn_tiles, [](std::int32_t i) { return paint_lawn(i, 128); }), 4));
    painted.files.push_back(sheet_file(
        "leaves.png", paint_all(leaf_patterns, [](std::int32_t i) { return paint_autumn_leaf(i, 128); }), 4));
    constexpr std::int32_t map_side = 32;
    painted.files.push_back(map_file("areas.png", map_side, paint_leaf_map(map_side)));
    // Copper, red, orange, brown, yellow, gold, turning, pale; −1 is no leaf
    const std::vector<Mixture> materials{
        {{-1, 28}, {0, 2}, {4, 2}},                                // open lawn
        {{-1, 7}, {4, 13}, {6, 6}, {7, 6}},                        // under a birch
        {{-1, 4}, {1, 16}, {2, 10}, {0, 2}},                       // under a maple
        {{-1, 5}, {3, 17}, {0, 8}, {6, 2}},                        // under an oak
        {{0, 6}, {1, 5}, {2, 6}, {3, 5}, {4, 4}, {5, 4}, {6, 2}},  // a drift of all
    };
    Blocks blocks{painted.scene};
    blocks.patterns("lawn-patterns", "lawn.png", 128, lawn_tiles);
    blocks.patterns("leaf-patterns", "leaves.png", 128, leaf_patterns);
    blocks.cells(128);
    blocks.index("which-lawn", lawn_tiles);
    blocks.texture("lawn", "lawn-patterns", "which-lawn");
    std::vector<std::string> layers{"lawn"};
    for (const std::string layer : {"lower", "upper"}) {
        blocks.areas(layer + "-areas", "areas.png", 4);
        blocks.index(layer + "-draw", 32, proto::Draw::independent);
        proto::MaterialsMap& mixed = *blocks.add(layer + "-kind").mutable_materials_map();
        mixed.mutable_material()->set_block(layer + "-areas");
        mixed.mutable_index()->set_block(layer + "-draw");
        for (const Mixture& mixture : materials) fill(*mixed.add_materials(), mixture);
        blocks.transform(
            layer, {.least_scale = 0.44, .most_scale = 0.7, .turns = 16, .scales = 2, .overflow = true});
        blocks.texture(layer + "-leaves", "leaf-patterns", layer + "-kind", layer);
        layers.push_back(layer + "-leaves");
    }
    blocks.layers(layers);
    return painted;
}

/// Four families over an extent of 2^30 texels.
PaintedScene paint_terrain() {
    constexpr std::int32_t families = land_families, mixed = families * families * families * families;
    struct Tile {
        Corners corners;
        std::int32_t variant = 0;
    };
    std::vector<Tile> tiles;
    for (std::int32_t i = 0; i < mixed; ++i) tiles.push_back({corners_of(i, families), 0});
    for (std::int32_t family = 0; family < families; ++family)
        for (std::int32_t variant = 1; variant < land_plain_tiles; ++variant)
            tiles.push_back({{family, family, family, family}, variant});
    PaintedScene painted;
    painted.scene.set_extent_log2_pages(22);
    painted.files.push_back(sheet_file("tiles.png",
                                       paint_all(static_cast<std::int32_t>(tiles.size()),
                                                 [&](std::int32_t i) {
                                                     const Tile& tile = tiles[static_cast<std::size_t>(i)];
                                                     return paint_land_tile(tile.corners, tile.variant, 64);
                                                 }),
                                       16));
    constexpr std::int32_t map_side = 1024;  // of 16384 cells of 64 texels: the whole extent
    painted.files.push_back(map_file("land.png", map_side, paint_land_map(map_side)));
    Blocks blocks{painted.scene};
    blocks.patterns("patterns", "tiles.png", 64, tiles.size());
    blocks.cells(64);
    blocks.areas("land", "land.png", 16384);
    blocks.index("which", land_plain_tiles, proto::Draw::independent);
    proto::TransitionTiles& transition = *blocks.add("borders").mutable_transition_tiles();
    transition.mutable_material()->set_block("land");
    transition.mutable_index()->set_block("which");
    transition.set_families(families);
    for (std::int32_t i = 0; i < mixed; ++i) {
        auto& combination = *transition.add_combinations();
        const Corners corners = corners_of(i, families);
        for (const std::int32_t corner : corners) combination.add_corners(static_cast<std::uint32_t>(corner));
        Mixture mixture{{i, 1}};
        if (corners == Corners{corners[0], corners[0], corners[0], corners[0]})
            for (std::int32_t variant = 1; variant < land_plain_tiles; ++variant)
                mixture.emplace_back(mixed + corners[0] * (land_plain_tiles - 1) + variant - 1, 1);
        fill(*combination.mutable_patterns(), mixture);
    }
    blocks.texture("tiles", "patterns", "borders");
    return painted;
}

/// Patterns over content exchange.
PaintedScene paint_petals() {
    PaintedScene painted;
    painted.on_pebbles = true;
    painted.files.push_back(sheet_file(
        "petals.png", paint_all(petal_patterns, [](std::int32_t i) { return paint_petal(i, 64); }), 3));
    Blocks blocks{painted.scene};
    proto::Exchange& pebbles = *blocks.add("pebbles").mutable_content_exchange();
    pebbles.set_asset("asset");
    pebbles.set_seed(1);
    blocks.patterns("patterns", "petals.png", 64, petal_patterns);
    blocks.cells(64);
    std::vector<std::string> layers{"pebbles"};
    for (const std::string layer : {"lower", "upper"}) {
        blocks.index(layer + "-draw", 32);
        proto::ProbabilityMap& kind = *blocks.add(layer + "-kind").mutable_probability_map();
        kind.mutable_index()->set_block(layer + "-draw");
        fill(*kind.mutable_material(), {{-1, 15}, {0, 4}, {1, 4}, {2, 4}, {3, 3}, {4, 1}, {5, 1}});
        blocks.transform(layer, {.least_scale = 0.45, .most_scale = 0.7, .turns = 32, .scales = 3});
        blocks.texture(layer + "-petals", "patterns", layer + "-kind", layer);
        layers.push_back(layer + "-petals");
    }
    blocks.layers(layers);
    return painted;
}

/// Sparse convolution of volumes: one slice at a time.
PaintedScene paint_grove() {
    constexpr std::int32_t ground_tiles = 8;
    PaintedScene painted;
    painted.files.push_back(sheet_file(
        "ground.png", paint_all(ground_tiles, [](std::int32_t i) { return paint_lawn(i, 64); }), 4));
    std::vector<Rgba8Image> trees;
    for (std::int32_t i = 0; i < tree_patterns; ++i)
        for (Rgba8Image& slice : paint_tree(i, 64)) trees.push_back(std::move(slice));
    painted.files.push_back(sheet_file("trees.png", trees, 8));
    Blocks blocks{painted.scene};
    blocks.patterns("ground-patterns", "ground.png", 64, ground_tiles);
    blocks.patterns("trees", "trees.png", 64, tree_patterns, tree_slices);
    blocks.cells(64, tree_slices);  // above its only slice, the ground is blank
    blocks.index("which-ground", ground_tiles);
    blocks.texture("ground", "ground-patterns", "which-ground");
    blocks.index("draw", 8);
    proto::ProbabilityMap& kind = *blocks.add("which-tree").mutable_probability_map();
    kind.mutable_index()->set_block("draw");
    fill(*kind.mutable_material(), {{-1, 2}, {0, 4}, {1, 2}});
    blocks.transform("place", {.least_scale = 0.5, .most_scale = 0.7, .turns = 8, .scales = 2});
    blocks.texture("grove", "trees", "which-tree", "place");
    blocks.layers({"ground", "grove"});
    return painted;
}

constexpr std::pair<std::string_view, PaintedScene (*)()> painters[] = {
    {"tiles", paint_tiles},   {"meadow-sand", paint_meadow_sand}, {"leaves", paint_leaves},
    {"autumn", paint_autumn}, {"terrain", paint_terrain},         {"petals", paint_petals},
    {"grove", paint_grove},
};

}  // namespace

const std::vector<std::string_view>& pattern_scene_names() {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> all;
        for (const auto& [name, paint] : painters) all.push_back(name);
        return all;
    }();
    return names;
}

PaintedScene paint_pattern_scene(std::string_view name) {
    for (const auto& [known, paint] : painters)
        if (known == name) return paint();
    return {};
}

}  // namespace tessera
