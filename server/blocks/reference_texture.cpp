// Reference Texture (3.2): "given a pattern index p and a texture coordinate … this block retrieves the
// color". What it looks like is the business of server/pattern.
#include <algorithm>

#include "server/blocks/compilation.h"
#include "server/filter/turning.h"

namespace tessera {

namespace {

/// Each instance has room in one cell, whatever its turn and scale.
Result<void> check_room(const Compilation& c, std::size_t block, const TransformPlan& plan, std::int32_t side,
                        std::int32_t cell) {
    const double widest = *std::max_element(plan.scales.begin(), plan.scales.end());
    for (const double turn : plan.turns) {
        if (bounding_side(side, widest, turn) <= cell) continue;
        // The largest scale, in steps of 1/1024, that fits at every turn
        int fits = 0;
        for (int low = 0, high = 4096; low <= high;) {
            const int scale = (low + high) / 2;
            const bool all = std::all_of(plan.turns.begin(), plan.turns.end(), [&](double t) {
                return bounding_side(side, scale / 1024.0, t) <= cell;
            });
            if (all)
                fits = scale, low = scale + 1;
            else
                high = scale - 1;
        }
        return c.error(block, ".transform",
                       "scales patterns of " + std::to_string(side) + " texels by up to " +
                           number_text(widest) + "; turned by " + number_text(turn) + " they need " +
                           std::to_string(bounding_side(side, widest, turn)) + " texels, and a cell has " +
                           std::to_string(cell) + ". The largest scale that fits is " +
                           number_text(fits / 1024.0));
    }
    return {};
}

Result<Scroll> read_scroll(Compilation& c, std::size_t block, const proto::ReferenceTexture& message) {
    constexpr std::int32_t most_cells = 1 << 20;
    const auto& given = message.scroll();
    if (given.cells() < -most_cells || given.cells() > most_cells)
        return c.error(block, ".scroll.cells", "is " + std::to_string(given.cells()) + "; within ±2^20");
    return Scroll{given.cells(), std::max(given.steps(), 1u)};
}

}  // namespace

Result<void> compile_reference_texture(Compilation& c, std::size_t block) {
    const proto::ReferenceTexture& message = c.graph.blocks[block].message->reference_texture();
    const std::size_t grid_block = c.named(message.grid());
    const auto& patterns = c.blocks[c.named(message.patterns())].patterns;
    const std::int32_t cell = std::int32_t{1} << c.grids.at(grid_block).grid.cell_log2;
    const auto check_grid = [&](std::string_view field, std::size_t grid) -> Result<void> {
        if (grid == no_block || grid == grid_block) return {};
        return c.error(block, field,
                       "lives on the grid \"" + c.graph.blocks[grid].message->name() +
                           "\", the texture on \"" + message.grid() + "\"; give both one grid");
    };

    const auto index = c.integer(block, ".index", message.index(), 0);
    if (!index) return index.error();
    const CellNode& shown = c.nodes[*index];
    if (auto same = check_grid(".index", shown.grid); !same) return same.error();
    if (shown.least < -1 || shown.most >= patterns->count)
        return c.error(block, ".index",
                       range_text(shown) + ", but \"" + message.patterns() + "\" holds patterns 0 to " +
                           std::to_string(patterns->count - 1) + "; add patterns, or choose among these");

    PendingReference reference;
    reference.block = block;
    reference.grid = grid_block;
    reference.index = *index;
    ReferencePlan plan;
    plan.patterns = patterns;
    if (message.transform().empty()) {
        if (patterns->side != cell)
            return c.error(block, ".patterns",
                           "names patterns of " + std::to_string(patterns->side) +
                               " texels, and the cells of \"" + message.grid() + "\" have " +
                               std::to_string(cell) + "; make them the same, or give a transform");
    } else {
        reference.transform = c.blocks[c.named(message.transform())].transform;
        if (auto same = check_grid(".transform", reference.transform->grid); !same) return same.error();
        plan.transform = reference.transform->plan;
        if (auto room = check_room(c, block, *plan.transform, patterns->side, cell); !room)
            return room.error();
    }
    if (auto scroll = read_scroll(c, block, message); !scroll)
        return scroll.error();
    else
        reference.scroll = *scroll;
    reference.texture = c.plan.textures.size();
    c.blocks[block].texture = reference.texture;
    c.plan.textures.push_back({c.graph.blocks[block].message->name(), std::move(plan)});
    c.references.push_back(std::move(reference));
    return {};
}

}  // namespace tessera
