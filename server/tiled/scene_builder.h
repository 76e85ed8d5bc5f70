#pragma once

#include <set>
#include <string>
#include <vector>

#include "server/tiled/tile_painter.h"
#include "server/tiled/tiled_scene.h"

namespace tessera {

/// The scene while it is being made: blocks with names of their own, sheets of patterns.
class SceneBuilder {
  public:
    SceneBuilder(const TiledMap& map, TiledScene& scene) : painter{map}, map_{map}, scene_{scene} {}

    /// A new block whose name is like `wish`, in the letters that blocks have.
    proto::Block& add_block(const std::string& wish);

    /// As many patterns of side² texels as one image holds, and a map can number.
    static std::int64_t most_patterns(std::int64_t side) noexcept;
    Error too_many_patterns(const std::string& whose) const;

    /// Adds a pattern set of these images, side² RGBA texels each, and its sheet. Error: invalid_input;
    /// `whose` they are begins the message.
    Result<std::string> add_patterns(const std::string& wish, const std::string& whose,
                                     const std::vector<std::uint8_t>& codes);

    /// Adds a sheet of these images, at most as many as one holds; the set that names it.
    proto::PatternSet add_sheet(const std::string& file, std::int64_t side,
                                const std::vector<std::uint8_t>& codes);

    const TiledMap& map() const noexcept { return map_; }
    TiledScene& scene() noexcept { return scene_; }

    const TilePainter painter;

  private:
    const TiledMap& map_;
    TiledScene& scene_;
    std::set<std::string> names_;
};

/// Adds the blocks of one layer; the name of its texture. Cells are counted from (first_x, first_y) on.
Result<std::string> add_layer(SceneBuilder& builder, const TileLayer& layer, std::int32_t first_x,
                              std::int32_t first_y, Progress& progress);

/// Adds what a tileset holds beside its tiles. `step_milliseconds`: one step of the animation clock.
Result<void> add_tileset(SceneBuilder& builder, const Tileset& set, std::uint32_t step_milliseconds);

/// Adds the tiles at free places as sprites over all layers, in the order of the map; how many. Cells are
/// counted from (first_x, first_y) on. `step_milliseconds` as above. Error: cancelled.
Result<std::size_t> add_sprites(SceneBuilder& builder, std::int32_t first_x, std::int32_t first_y,
                                std::uint32_t step_milliseconds, Progress& progress);

inline constexpr const char* grid_name = "cells";

}  // namespace tessera
