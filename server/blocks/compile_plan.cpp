#include <algorithm>
#include <utility>

#include "server/blocks/compilation.h"
#include "server/blocks/draw_field.h"
#include "server/blocks/look_program.h"

namespace tessera {

namespace {

Result<void> compile_block(Compilation& c, std::size_t block) {
    switch (c.graph.blocks[block].message->block_case()) {
        case proto::Block::kPatternSet:
            return compile_pattern_set(c, block);
        case proto::Block::kVirtualTileMap:
            return compile_virtual_tile_map(c, block);
        case proto::Block::kExplicitIndirectionMap:
            return compile_explicit_indirection_map(c, block);
        case proto::Block::kVirtualIndirectionMap:
            return compile_virtual_indirection_map(c, block);
        case proto::Block::kVirtualRandomMap:
            return compile_virtual_random_map(c, block);
        case proto::Block::kProbabilityMap:
            return compile_probability_map(c, block);
        case proto::Block::kMaterialsMap:
            return compile_materials_map(c, block);
        case proto::Block::kAreasMap:
            return compile_areas_map(c, block);
        case proto::Block::kDitheredAreasMap:
            return compile_dithered_areas_map(c, block);
        case proto::Block::kTransitionTiles:
            return compile_transition_tiles(c, block);
        case proto::Block::kAnimationSequence:
            return compile_animation_sequence(c, block);
        case proto::Block::kAnimationMap:
            return compile_animation_map(c, block);
        case proto::Block::kTileTransform:
            return compile_tile_transform(c, block);
        case proto::Block::kReferenceTexture:
            return compile_reference_texture(c, block);
        case proto::Block::kPixelMap:
            return compile_pixel_map(c, block);
        case proto::Block::kLayers:
            return compile_layers(c, block);
        case proto::Block::kConstant:
        case proto::Block::kContentExchange:
        case proto::Block::kInterchange:
        case proto::Block::kWang:
            return compile_given(c, block);
        case proto::Block::BLOCK_NOT_SET:
            break;
    }
    return {};  // check_graph refused it
}

Rate rate_of(const Compilation& c, std::size_t block) {
    switch (c.graph.blocks[block].output) {
        case Output::texture:
            return Rate::texel;
        case Output::integer:
        case Output::number: {
            const CellNode& node = c.node_of(block);
            if (node.constant()) return Rate::scene;
            const bool looks_around = node.driven && node.driven->looks_at_targets();
            return node.grid == no_block && !looks_around ? Rate::step : Rate::cell;
        }
        case Output::transform: {
            const TransformNodes& transform = *c.blocks[block].transform;
            for (const std::size_t node : {transform.x, transform.y, transform.turn, transform.scale})
                if (!c.nodes[node].constant()) return Rate::cell;
            return Rate::scene;
        }
        default:
            return Rate::scene;
    }
}

void write_lines(Compilation& c) {
    for (std::size_t block = 0; block < c.graph.blocks.size(); ++block) {
        const GraphBlock& of = c.graph.blocks[block];
        PlanLine line{of.message->name(), of.kind, Rate::scene, c.notes[block], false};
        const std::size_t node = c.blocks[block].node;
        if (of.reached) {
            line.rate = rate_of(c, block);
            if (node != no_block && !c.nodes[node].constant() && !c.nodes[node].shown) {
                line.dropped = true;
                line.note = "dropped: what reads it is constant";
            }
        } else {
            line.dropped = true;
            line.note = "dropped: does not reach the output";
        }
        c.plan.lines.push_back(std::move(line));
    }
}

Result<void> compile_blocks(Compilation& c, const std::vector<std::size_t>& order) {
    // How many patterns there are says what edits may write into maps
    const auto is_set = [&](std::size_t block) {
        return c.graph.blocks[block].message->block_case() == proto::Block::kPatternSet;
    };
    for (const bool sets : {true, false})
        for (const std::size_t block : order)
            if (is_set(block) == sets)
                if (auto compiled = compile_block(c, block); !compiled) return compiled.error();
    return {};
}

/// What does not reach the output is compiled like all else, files and all, so that its faults are told; and
/// then thrown away.
Result<void> check_unreached(Compilation c) {
    if (c.graph.unreached.empty()) return {};
    if (auto compiled = compile_blocks(c, c.graph.unreached); !compiled) return compiled.error();
    return choose_generators(c);
}

/// Their programs, now that every draw has its op; and their grids, now that they have their quadtrees.
Result<void> compile_references(Compilation& c) {
    const std::size_t zero = c.add_constant(0, true), one = c.add_constant(number_one, true);
    const auto nodes = std::make_shared<const std::vector<CellNode>>(std::move(c.nodes));
    for (const PendingReference& reference : c.references) {
        const GridBlock& grid = c.grids.at(reference.grid);
        if (grid.grid.quadtree != nullptr) {
            // A look and a pattern for each type
            const std::size_t table = std::size_t{grid.types} * 4;
            if (table > c.table_room)
                return c.error(
                    reference.block, "",
                    "shows one look for each type, of which all textures together have too many; give "
                    "grids fewer types, or make draws independent");
            c.table_room -= table;
        }
        auto& plan = std::get<ReferencePlan>(c.plan.textures[reference.texture].what);
        plan.grid = grid.grid;
        if (const TransformNodes* transform = reference.transform.get(); transform != nullptr)
            plan.program = make_look_program(
                nodes, {reference.index, transform->x, transform->y, transform->turn, transform->scale},
                transform->steps, grid.types, grid.grid.cell_log2, reference.scroll);
        else
            plan.program = make_look_program(nodes, {reference.index, zero, zero, zero, one},
                                             {.scale_least = number_one, .scale_most = number_one},
                                             grid.types, grid.grid.cell_log2, reference.scroll);
    }
    return {};
}

}  // namespace

Result<Plan> compile_plan(const proto::Pattern& message, BlockFiles& files) {
    const auto graph = check_graph(message);
    if (!graph) return graph.error();
    Compilation c{.graph = *graph, .files = files, .seed = message.seed()};
    c.blocks.resize(graph->blocks.size());
    c.notes.resize(graph->blocks.size());
    if (auto compiled = compile_blocks(c, graph->order); !compiled) return compiled.error();
    if (auto checked = check_unreached(c); !checked) return checked.error();
    if (auto chosen = choose_generators(c); !chosen) return chosen.error();
    write_lines(c);
    find_support(c);
    if (auto compiled = compile_references(c); !compiled) return compiled.error();
    std::sort(c.plan.parameters.begin(), c.plan.parameters.end());
    c.plan.parameters.erase(std::unique(c.plan.parameters.begin(), c.plan.parameters.end()),
                            c.plan.parameters.end());
    return std::move(c.plan);
}

}  // namespace tessera
