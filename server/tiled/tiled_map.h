#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/scene/image_file.h"
#include "shared/result/result.h"

namespace tessera {

/// A tile as maps name it: the number of the tile, counted through all tilesets from 1 on, and its flips.
struct TileRef {
    std::uint32_t gid = 0;  ///< As stored: flips in the highest bits. 0: no tile.

    static constexpr std::uint32_t flipped_x = 1u << 31, flipped_y = 1u << 30, transposed = 1u << 29,
                                   turned_hexagon = 1u << 28;
    constexpr std::uint32_t number() const noexcept { return gid & ~(15u << 28); }
    constexpr bool has(std::uint32_t flip) const noexcept { return (gid & flip) != 0; }
};

/// One image, or a part of one, as a tile shows it. In texels of `image`.
struct TileImage {
    std::size_t image = 0;  ///< Of TiledMap::images.
    std::int32_t x = 0, y = 0, width = 0, height = 0;
};

struct TileAnimation {
    struct Frame {
        std::uint32_t tile = 0;
        std::uint32_t milliseconds = 1;
    };
    std::vector<Frame> frames;
};

/// Corner colours of a tile, from 1 on, 0 for none: top left, top right, bottom left, bottom right.
struct WangTile {
    std::uint32_t tile = 0;
    std::array<std::uint8_t, 4> corners{};
};

struct WangSet {
    std::string name;
    std::vector<std::string> colors;  ///< Names; color 1 first.
    std::vector<WangTile> tiles;
};

struct Tileset {
    std::string name;
    std::uint32_t first = 1;  ///< The number of its tile 0 in the map.
    std::map<std::uint32_t, TileImage> tiles;
    std::int32_t offset_x = 0, offset_y = 0;  ///< Of its tiles where they are drawn, in texels.
    double align_x = 0,
           align_y =
               1;  ///< Which point of an object's tile is its position: 0 left or top, 1 right or bottom.
    std::map<std::uint32_t, double> probabilities;  ///< Those that are not 1.
    std::map<std::uint32_t, TileAnimation> animations;
    std::vector<WangSet> wang_sets;
};

/// A layer of tiles on a rectangle of cells.
struct TileLayer {
    std::string name;
    std::int32_t x = 0, y = 0, width = 0, height = 0;  ///< In cells; an infinite map's may start below 0.
    std::vector<TileRef> tiles;                        ///< Rows from the top.
    double opacity = 1;
    std::array<double, 4> tint{1, 1, 1, 1};  ///< Red, green, blue, alpha: factors of codes.
    double offset_x = 0, offset_y = 0;       ///< In texels.
};

/// A tile at a free place.
struct TileObject {
    TileRef tile;
    double x = 0, y = 0;           ///< In texels: of the point that its tileset aligns, about which it turns.
    double width = 0, height = 0;  ///< As it is shown, in texels; 0: as the tile is.
    double turn = 0;               ///< Clockwise, from 0 to 1.
};

struct ObjectLayer {
    std::string name;
    std::vector<TileObject> objects;  ///< In the order in which they are drawn.
    std::size_t above = 0;            ///< How many layers of tiles are drawn before it.
    double opacity = 1;
    std::array<double, 4> tint{1, 1, 1, 1};
    double offset_x = 0, offset_y = 0;
};

/// What a map of the Tiled editor says, as far as it can become a texture.
struct TiledMap {
    std::int32_t tile_width = 0, tile_height = 0;
    std::int32_t width = 0, height = 0;  ///< In cells; 0 for an infinite map.
    std::optional<std::array<std::uint8_t, 4>> background;
    std::vector<StraightRgba8Image> images;
    std::vector<Tileset> tilesets;      ///< By `first`.
    std::vector<TileLayer> layers;      ///< From the ground up, all visible.
    std::vector<ObjectLayer> objects;   ///< The same; each has some.
    std::vector<std::string> left_out;  ///< What it cannot become: a sentence each.
};

/// Reads a map and all that it names. XML entities and document types are not followed, sizes are limited.
/// Errors: invalid_input, io_failure; the message names file, element and fix.
Result<TiledMap> read_tiled_map(const std::filesystem::path& file);

inline constexpr std::int64_t max_tiled_cells = std::int64_t{1} << 24;  ///< Of one layer.
inline constexpr std::int32_t max_tile_texels = 1024;                   ///< Of a tile's side.

}  // namespace tessera
