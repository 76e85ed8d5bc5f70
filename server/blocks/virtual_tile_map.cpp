// Virtual Tile Map (3.2, figure 2.1): the grid of cells over the whole plane.
#include "server/blocks/compilation.h"
#include "server/blocks/map_field.h"

namespace tessera {

Result<void> compile_virtual_tile_map(Compilation& c, std::size_t block) {
    const proto::VirtualTileMap& message = c.graph.blocks[block].message->virtual_tile_map();
    const int cell_log2 = power_of_two(message.cell_texels(), 0, 12);
    if (cell_log2 < 0)
        return c.error(block, ".cell_texels",
                       "is " + std::to_string(message.cell_texels()) + "; a power of two from 1 to 4096");
    if (message.cell_slices() > 1024)
        return c.error(block, ".cell_slices",
                       "is " + std::to_string(message.cell_slices()) + "; at most 1024, or unset");
    const int types_log2 = power_of_two(message.types(), 4096, 14);
    if (types_log2 < 6)
        return c.error(block, ".types",
                       "is " + std::to_string(message.types()) + "; a power of two from 64 to 16384");
    GridBlock grid;
    grid.grid.name = c.graph.blocks[block].message->name();
    grid.grid.cell_log2 = cell_log2;
    grid.grid.cell_slices = static_cast<std::int32_t>(message.cell_slices());
    grid.types = 1u << types_log2;
    c.notes[block] = "cells of " + std::to_string(1 << cell_log2) + " texels";
    c.grids.emplace(block, std::move(grid));
    return {};
}

}  // namespace tessera
