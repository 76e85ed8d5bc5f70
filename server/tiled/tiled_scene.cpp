#include "server/tiled/tiled_scene.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "server/tiled/scene_builder.h"

namespace tessera {
namespace {

constexpr std::int64_t max_sheet_side = 32768;
constexpr std::int64_t max_sheet_texels = std::int64_t{1}
                                          << 25;  ///< What a scene has room for when it is loaded.
constexpr std::size_t longest_name = 48;

std::string size_text(std::int64_t width, std::int64_t height) {
    return std::to_string(width) + "×" + std::to_string(height);
}

void say_size(SceneBuilder& builder) {
    const TiledMap& map = builder.map();
    const std::int32_t side = builder.painter.side();
    if (map.tile_width == side && map.tile_height == side) return;
    builder.scene().left_out.push_back(
        "tiles of " + size_text(map.tile_width, map.tile_height) +
        " texels: cells are powers of two, so they have " + size_text(side, side) +
        ", each texel the mean of the area that it covers" +
        (map.tile_width == map.tile_height ? "" : "; the picture is stretched"));
}

/// The longest time of which all frames are whole numbers.
std::uint32_t step_of(const TiledMap& map) {
    std::uint32_t step = 0;
    for (const Tileset& set : map.tilesets)
        for (const auto& [tile, animation] : set.animations)
            for (const auto& frame : animation.frames) step = std::gcd(step, frame.milliseconds);
    return std::max(1u, step);
}

bool moves(const TiledMap& map) {
    return std::ranges::any_of(map.tilesets, [](const Tileset& set) { return !set.animations.empty(); });
}

}  // namespace

proto::Block& SceneBuilder::add_block(const std::string& wish) {
    std::string name;
    for (const char c : wish) {
        const bool plain =
            (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
        if (plain)
            name += c;
        else if (!name.empty() && name.back() != '-')
            name += '-';
    }
    name.resize(std::min(name.size(), longest_name));
    if (name.empty()) name = "layer";
    std::string own = name;
    for (int i = 2; !names_.insert(own).second; ++i) own = name + "-" + std::to_string(i);
    proto::Block& block = *scene_.scene.mutable_pattern()->add_blocks();
    block.set_name(own);
    return block;
}

std::int64_t SceneBuilder::most_patterns(std::int64_t side) noexcept {
    // A sheet that is nearly square has at most a row more than it needs
    const std::int64_t in_a_row = max_sheet_side / side - 1;
    return std::clamp<std::int64_t>(max_sheet_texels / (side * side), 1,
                                    std::min<std::int64_t>(65535, in_a_row * in_a_row));
}

Error SceneBuilder::too_many_patterns(const std::string& whose) const {
    return {ErrorCode::invalid_input, whose + " has more than " +
                                          std::to_string(most_patterns(painter.side())) +
                                          " different cells of " + size_text(painter.side(), painter.side()) +
                                          " texels, as many as an image of patterns holds; split it"};
}

Result<std::string> SceneBuilder::add_patterns(const std::string& wish, const std::string& whose,
                                               const std::vector<std::uint8_t>& codes) {
    const std::int64_t side = painter.side();
    if (std::ssize(codes) / (side * side * 4) > most_patterns(side)) return too_many_patterns(whose);
    proto::Block& block = add_block(wish);
    *block.mutable_pattern_set() = add_sheet(block.name() + ".png", side, codes);
    return block.name();
}

proto::PatternSet SceneBuilder::add_sheet(const std::string& file, std::int64_t side,
                                          const std::vector<std::uint8_t>& codes) {
    const std::int64_t count = std::ssize(codes) / (side * side * 4);
    const std::int64_t columns = std::min<std::int64_t>(
        count, std::max<std::int64_t>(1, std::llround(std::ceil(std::sqrt(double(count))))));
    const std::int64_t rows = (count + columns - 1) / columns;
    TiledScene::Sheet sheet{file, {}};
    sheet.image.width = static_cast<std::int32_t>(columns * side);
    sheet.image.height = static_cast<std::int32_t>(rows * side);
    sheet.image.bytes.resize(std::size_t(columns * rows * side * side * 4));
    for (std::int64_t i = 0; i < count; ++i)
        for (std::int64_t y = 0; y < side; ++y)
            std::copy_n(codes.begin() + ((i * side + y) * side) * 4, side * 4,
                        sheet.image.bytes.begin() +
                            ((i / columns * side + y) * columns * side + i % columns * side) * 4);
    proto::PatternSet set;
    set.set_image(sheet.file);
    set.set_side_texels(static_cast<std::uint32_t>(side));
    set.set_count(static_cast<std::uint32_t>(count));
    scene_.sheets.push_back(std::move(sheet));
    return set;
}

Result<TiledScene> to_scene(const TiledMap& map, const std::string& title, Progress& progress) {
    TiledScene scene;
    scene.left_out = map.left_out;
    scene.scene.set_title(title);
    SceneBuilder builder{map, scene};
    builder.add_block(grid_name).mutable_virtual_tile_map()->set_cell_texels(
        static_cast<std::uint32_t>(builder.painter.side()));
    say_size(builder);

    // An infinite map has no corner: its top-left tile comes to the texture's
    std::int32_t first_x = 0, first_y = 0;
    std::int64_t width = map.width, height = map.height;
    if (map.width == 0)
        for (const ObjectLayer& layer : map.objects)
            for (const TileObject& object : layer.objects) {
                width = std::max<std::int64_t>(width, std::llround(object.x / map.tile_width) + 1);
                height = std::max<std::int64_t>(height, std::llround(object.y / map.tile_height) + 1);
            }
    if (map.width == 0 && !map.layers.empty()) {
        first_x = std::ranges::min(map.layers, {}, &TileLayer::x).x;
        first_y = std::ranges::min(map.layers, {}, &TileLayer::y).y;
        for (const TileLayer& layer : map.layers) {
            width = std::max<std::int64_t>(width, layer.x - first_x + layer.width);
            height = std::max<std::int64_t>(height, layer.y - first_y + layer.height);
        }
        if (first_x != 0 || first_y != 0)
            scene.made.push_back("an infinite map: its cell (" + std::to_string(first_x) + ", " +
                                 std::to_string(first_y) + ") is the texture's corner");
    }

    std::vector<std::string> textures;
    if (map.background) {
        proto::Block& ground = builder.add_block("background");
        const auto& [red, green, blue, alpha] = *map.background;
        ground.mutable_constant()->set_red(red);
        ground.mutable_constant()->set_green(green);
        ground.mutable_constant()->set_blue(blue);
        ground.mutable_constant()->set_alpha(alpha);
        textures.push_back(ground.name());
    }
    for (std::size_t i = 0; i < map.layers.size(); ++i) {
        if (progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
        const auto texture = add_layer(builder, map.layers[i], first_x, first_y, progress);
        if (!texture) return texture.error();
        if (!texture->empty()) textures.push_back(*texture);
        progress.advance("painting", double(i + 1) / double(map.layers.size()));
    }
    const std::uint32_t step = step_of(map);
    const auto sprites = add_sprites(builder, first_x, first_y, step, progress);
    if (!sprites) return sprites.error();
    if (textures.empty() && *sprites > 0) {
        // Sprites need a texture to lie on
        proto::Block& nothing = builder.add_block("nothing");
        nothing.mutable_constant()->set_alpha(0);
        textures.push_back(nothing.name());
    }
    if (textures.empty())
        return Error{ErrorCode::invalid_input,
                     "no layer of the map shows a tile or a sprite; there is no texture in it"};
    for (const Tileset& set : map.tilesets)
        if (auto added = add_tileset(builder, set, step); !added) return added.error();

    std::string output = textures.front();
    if (textures.size() > 1) {
        proto::Block& layers = builder.add_block("map");
        for (const std::string& texture : textures) layers.mutable_layers()->add_textures(texture);
        output = layers.name();
    }
    scene.scene.mutable_pattern()->set_output(output);
    if (moves(map)) scene.scene.mutable_clock()->set_steps_per_second(1000.0 / step);
    const auto pages =
        static_cast<std::uint64_t>((std::max(width, height) * builder.painter.side() + 255) / 256);
    scene.scene.set_extent_log2_pages(
        static_cast<std::uint32_t>(std::clamp(static_cast<int>(std::bit_width(pages - 1)), 1, 30)));
    // The middle of the map, which is not that of the extent, as large as a window of a thousand pixels
    const auto longest = static_cast<double>(std::max(width, height) * builder.painter.side());
    proto::OpeningView& view = *scene.scene.mutable_view();
    view.set_x(width * builder.painter.side() / 2);
    view.set_y(height * builder.painter.side() / 2);
    view.set_level(std::max(0.0, std::log2(longest / 1024)));
    return scene;
}

std::string TiledScene::report() const {
    std::string text = "Made:\n";
    for (const std::string& line : made) text += "  " + line + '\n';
    text += left_out.empty() ? "Nothing was left out.\n" : "Not as in the map:\n";
    for (const std::string& line : left_out) text += "  " + line + '\n';
    return text;
}

}  // namespace tessera
