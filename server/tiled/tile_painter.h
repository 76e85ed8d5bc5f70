#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/tiled/tiled_map.h"

namespace tessera {

/// A tile as it lies in a cell: where its top-left corner is, relative to the cell's, in texels of the map.
struct PlacedTile {
    TileRef tile;
    std::int32_t x = 0, y = 0;
    auto operator<=>(const PlacedTile& other) const {
        return std::array<std::int64_t, 3>{tile.gid, x, y} <=>
               std::array<std::int64_t, 3>{other.tile.gid, other.x, other.y};
    }
    bool operator==(const PlacedTile& other) const { return (*this <=> other) == 0; }
};

/// Paints what cells of a map show, as patterns.
class TilePainter {
  public:
    explicit TilePainter(const TiledMap& map);

    /// The side of a pattern: the power of two nearest to a tile's side (to the root of its area).
    std::int32_t side() const noexcept { return side_; }

    /// Null if no tileset has the tile.
    const TileImage* find(TileRef tile) const noexcept;
    const Tileset* tileset_of(TileRef tile) const noexcept;

    /// Appends side()² texels to `codes`: these tiles, one over the other, as the layer shows them. They are
    /// composited premultiplied in linear light; where side() is not the tile's own, every texel is the exact
    /// mean of the area that it covers.
    void paint(const std::vector<PlacedTile>& tiles, double opacity, const std::array<double, 4>& tint,
               std::vector<std::uint8_t>& codes) const;

    /// Appends side² texels to `codes`: one tile brought to width × height texels, each the mean of the area
    /// that it covers, in the middle (the texel to its left or above where that is none) of nothing. Both are
    /// 1 to `side`.
    void paint_alone(TileRef tile, std::int32_t width, std::int32_t height, std::int32_t side, double opacity,
                     const std::array<double, 4>& tint, std::vector<std::uint8_t>& codes) const;

  private:
    const TiledMap& map_;
    std::int32_t side_;
};

}  // namespace tessera
