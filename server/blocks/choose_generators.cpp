#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "server/blocks/draw_field.h"
#include "server/blocks/generators.h"
#include "server/blocks/row_hash.h"
#include "shared/math/hash.h"

namespace tessera {

namespace {

constexpr std::size_t max_typed_grids = 64;  // Each holds tables of some megabytes

/// The nodes that the looks of a reference texture come from.
std::vector<std::size_t> nodes_under(const Compilation& c, const PendingReference& reference) {
    std::vector<bool> needed(c.nodes.size(), false);
    needed[reference.index] = true;
    if (const TransformNodes* transform = reference.transform.get(); transform != nullptr)
        for (const std::size_t node : {transform->x, transform->y, transform->turn, transform->scale})
            needed[node] = true;
    std::vector<std::size_t> under;
    for (std::size_t node = c.nodes.size(); node-- > 0;) {
        if (!needed[node]) continue;
        under.push_back(node);
        for (const std::size_t input : c.nodes[node].inputs) needed[input] = true;
    }
    return under;
}

std::string_view generator_word(Generator generator) {
    switch (generator) {
        case proto::Draw::typed:
            return "typed";
        case proto::Draw::nested:
            return "nested";
        case proto::Draw::sigma:
            return "sigma";
        default:
            return "independent";
    }
}

/// Grids of as many types and slices share one quadtree, each from the height of its own cells on: what lies
/// under a large cell's type is then a function of it in all of them, and composites of their textures are
/// exact at every level. The first of them in the scene file names the tree, so that grids added behind it
/// shift nothing.
void grow_quadtrees(Compilation& c, const std::set<std::size_t>& typed_grids) {
    std::map<std::pair<std::uint32_t, std::int32_t>, const Grid*> first_of;
    for (const std::size_t block : typed_grids) {
        GridBlock& grid = c.grids.at(block);
        const auto [at, is_first] = first_of.try_emplace({grid.types, grid.grid.cell_slices}, &grid.grid);
        const Grid& first = *at->second;
        if (is_first)
            grid.grid.quadtree = std::make_shared<const TypedQuadtree>(
                mix(c.seed ^ stream("grid " + grid.grid.name)), grid.types);
        else if (grid.grid.cell_log2 == first.cell_log2)
            grid.grid.quadtree = first.quadtree;
        else
            grid.grid.quadtree = std::make_shared<const TypedQuadtree>(
                first.quadtree->lifted(grid.grid.cell_log2 - first.cell_log2));
    }
}

}  // namespace

Result<void> choose_generators(Compilation& c) {
    struct Looks {
        std::size_t block;
        std::vector<std::size_t> draws;
        const CellNode* varies = nullptr;  // Why draws may not be typed: a map, …
        std::size_t corners = no_block;    // … draws that neighbours see, …
        const CellNode* moves = nullptr;   // … an animation, …
        bool scrolls = false;              // … cells that run, …
        bool mixed = false;                // … or another generator.
    };
    std::vector<Looks> textures;
    std::vector<bool> at_corners(c.nodes.size(), false);
    for (std::size_t node = c.nodes.size(); node-- > 0;) {
        const CellNode& user = c.nodes[node];
        for (std::size_t i = 0; i < user.inputs.size(); ++i)
            if (at_corners[node] || (user.corners && i == 0)) at_corners[user.inputs[i]] = true;
    }
    for (const PendingReference& reference : c.references) {
        Looks texture{.block = reference.block, .draws = {}, .scrolls = reference.scroll.cells != 0};
        for (const std::size_t node : nodes_under(c, reference)) {
            c.nodes[node].shown = true;
            if (c.nodes[node].map) texture.varies = &c.nodes[node];
            if (c.nodes[node].animation || c.nodes[node].driven) texture.moves = &c.nodes[node];
            const bool nested = c.nodes[node].draw ? c.nodes[node].draw->generator == proto::Draw::nested
                                                   : c.nodes[node].map && c.nodes[node].map->nested;
            if (c.nodes[node].map && texture.scrolls) {
                const std::int32_t entries = 8 << c.nodes[node].map->map->cells_log2;
                if (reference.scroll.cells % entries != 0)
                    return c.error(reference.block, ".scroll.cells",
                                   "is " + std::to_string(reference.scroll.cells) + "; a multiple of " +
                                       std::to_string(entries) + ", since a map decides what is shown");
            }
            if (nested && texture.scrolls)
                return c.error(c.nodes[node].block, ".generator",
                               "is nested, but what shows it scrolls; make it independent");
            if (nested && at_corners[node])
                return c.error(c.nodes[node].block, ".generator",
                               "is nested, whose neighbours avoid each other, but transition tiles look at "
                               "neighbours; make it independent");
            if (!c.nodes[node].draw) continue;
            texture.draws.push_back(node);
            if (at_corners[node]) texture.corners = node;
        }
        textures.push_back(std::move(texture));
    }

    // Draws become independent one texture after the other, until no more do
    for (bool changed = true; changed;) {
        changed = false;
        for (Looks& texture : textures) {
            if (texture.mixed) continue;
            texture.mixed = texture.varies != nullptr || texture.corners != no_block ||
                            texture.moves != nullptr || texture.scrolls;
            for (const std::size_t node : texture.draws) {
                const Generator generator = c.nodes[node].draw->generator;
                texture.mixed |= generator != proto::Draw::automatic && generator != proto::Draw::typed;
            }
            if (!texture.mixed) continue;
            for (const std::size_t node : texture.draws) {
                Generator& generator = c.nodes[node].draw->generator;
                if (generator == proto::Draw::automatic) generator = proto::Draw::independent, changed = true;
            }
        }
    }
    for (const Looks& texture : textures) {
        for (const std::size_t node : texture.draws) {
            const CellNode& draw = c.nodes[node];
            if (draw.draw->generator != proto::Draw::typed) continue;
            const auto name = [&](std::size_t block) {
                return "\"" + c.graph.blocks[block].message->name() + "\"";
            };
            if (texture.varies != nullptr)
                return c.error(draw.block, ".generator",
                               "is typed, but the looks of " + name(texture.block) +
                                   " vary over the plane with " + name(texture.varies->block) +
                                   "; leave it out, or make it independent");
            if (texture.moves != nullptr)
                return c.error(draw.block, ".generator",
                               "is typed, but the looks of " + name(texture.block) + " move with " +
                                   name(texture.moves->block) + "; leave it out, or make it independent");
            if (texture.scrolls)
                return c.error(draw.block, ".generator",
                               "is typed, but " + name(texture.block) +
                                   " scrolls; leave it out, or make it independent");
            if (at_corners[node])
                return c.error(
                    draw.block, ".generator",
                    "is typed, but transition tiles read it in neighbouring cells; leave it out, or "
                    "make it independent");
        }
    }

    std::set<std::size_t> typed_grids;
    for (CellNode& node : c.nodes) {
        if (!node.draw || !node.shown) continue;
        CellDraw& draw = *node.draw;
        GridBlock& grid = c.grids.at(node.grid);
        if (draw.generator == proto::Draw::automatic) draw.generator = proto::Draw::typed;
        switch (draw.generator) {
            case proto::Draw::typed:
                if (grid.types > c.table_room)
                    return c.error(
                        node.block, "",
                        "draws by types, of which all draws together have too many; give grids fewer "
                        "types, or make draws independent");
                c.table_room -= grid.types;
                draw.types = grid.types;
                if (typed_grids.insert(node.grid).second) {
                    if (typed_grids.size() > max_typed_grids)
                        return c.error(node.grid, "",
                                       "is one of more than " + std::to_string(max_typed_grids) +
                                           " grids with typed draws; share grids, or make draws independent");
                    c.notes[node.grid] += ", " + std::to_string(grid.types) + " types";
                }
                node.op = make_typed_op(c.seed, draw);
                break;
            case proto::Draw::nested:
                node.op = make_nested_op(c.seed, draw);
                break;
            case proto::Draw::sigma:
                node.op = make_sigma_op(c.seed, draw);
                break;
            default:
                draw.base = stream_base(c.seed, draw.key);
                node.op = make_independent_op(draw);
                break;
        }
        std::string& note = c.notes[node.block];
        note = std::string{generator_word(draw.generator)} +
               (draw.types != 0 ? ", " + std::to_string(draw.types) + " types" : std::string{}) + ", draws " +
               std::to_string(draw.count) + (note.empty() ? "" : ", " + note);
    }
    grow_quadtrees(c, typed_grids);
    return {};
}

}  // namespace tessera
