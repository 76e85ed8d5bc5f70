#include "server/blocks/editable_map.h"

#include <algorithm>

#include "server/blocks/compilation.h"

namespace tessera {

namespace {

/// More values than this are not worked out one by one.
constexpr std::int32_t most_values = 4096;
/// What repeats after no more cells than this is summed by periods, or drawn once for all.
constexpr std::int64_t most_period = 4096;
/// More boxes than this are one.
constexpr std::int64_t most_repeats = 16;
/// How much instances that hang over hide of each other is looked up near the origin
/// (server/pattern/overflow_texture.cpp).
constexpr std::int64_t sampled_texels = 2048, sampled_cells = 65;

constexpr std::int64_t everywhere = std::int64_t{1} << 39;

/// One axis of what depends on entries, in texels.
struct Span {
    std::int64_t from, to;
};

struct Axis {
    std::int64_t first;    ///< Entry
    std::int32_t entries;  ///< That are asked for, …
    std::int32_t side;     ///< … of so many.
    std::int64_t place;    ///< Cell of entry 0.
    bool between;
};

Span span_of(const EditableMap& map, const Axis& axis) {
    const bool patches = axis.between || map.reach > 0;
    const std::int64_t from = axis.first - (patches ? 1 : 0), to = axis.first + axis.entries;
    const std::int64_t cells = std::int64_t{1} << map.map.cells_log2,
                       texels = std::int64_t{1} << map.cell_log2;
    Span span{(axis.place + from * cells - map.reach) * texels,
              (axis.place + to * cells + (map.overflow ? 1 : 0)) * texels};
    if (map.map.edge == StoredMap::Edge::clamp) {
        if (axis.first == 0) span.from = -everywhere;
        if (to == axis.side) span.to = everywhere;
    }
    return {std::max(span.from, -everywhere), std::min(span.to, everywhere)};
}

/// The span and its repetitions in what pages and their gutters see.
std::vector<Span> repeated(const Span& span, std::int64_t period, std::int64_t side) {
    const std::int64_t low = -side / 4, high = side + side / 4;
    const auto floored = [&](std::int64_t a) { return a >= 0 ? a / period : -((period - 1 - a) / period); };
    std::vector<Span> spans;
    // span.to + k·period > low, span.from + k·period < high
    for (std::int64_t k = floored(low - span.to) + 1; span.from + k * period < high; ++k) {
        if (static_cast<std::int64_t>(spans.size()) == most_repeats) return {};
        spans.push_back({span.from + k * period, span.to + k * period});
    }
    return spans;
}

}  // namespace

std::vector<TexelBox> texels_of_entries(const EditableMap& map, const EntryBox& entries, Extent extent) {
    if (!map.shown) return {};
    if (map.scrolls) return {every_texel};
    const StoredMap& stored = map.map;
    const bool wraps = stored.edge == StoredMap::Edge::wrap;
    const std::int64_t larger = std::int64_t{std::max(stored.width, stored.height)} << stored.cells_log2;
    if (!stored.bounded() || (wraps && larger <= most_period)) return {every_texel};
    const Span x = span_of(map, {entries.x, entries.width, stored.width, stored.x, map.between_x});
    const Span y = span_of(map, {entries.y, entries.height, stored.height, stored.y, map.between_y});
    std::vector<Span> columns{x}, rows{y};
    if (wraps) {
        const int entry_log2 = stored.cells_log2 + map.cell_log2;
        const std::int64_t side = extent.side_texels();
        columns = repeated(x, std::int64_t{stored.width} << entry_log2, side);
        rows = repeated(y, std::int64_t{stored.height} << entry_log2, side);
        if (columns.empty() || rows.empty()) return {every_texel};
    }
    std::vector<TexelBox> boxes;
    const std::int64_t sampled = std::max(sampled_texels, sampled_cells << map.cell_log2);
    for (const Span& row : rows)
        for (const Span& column : columns) {
            if (map.overflow && column.from < sampled && column.to > -sampled && row.from < sampled &&
                row.to > -sampled)
                return {every_texel};
            boxes.push_back({column.from, row.from, column.to, row.to});
        }
    if (static_cast<std::int64_t>(boxes.size()) > most_repeats) return {every_texel};
    return boxes;
}

bool is_editable(const proto::Block& block, std::string_view what) {
    return std::find(block.editable().begin(), block.editable().end(), what) != block.editable().end();
}

std::optional<std::pair<std::int32_t, std::int32_t>> paintable_range(const Compilation& c,
                                                                     std::size_t block) {
    std::int32_t least = -1, most = most_values;
    for (const std::size_t reader : c.graph.order)
        for (const BlockReference& reference : c.graph.blocks[reader].references) {
            if (reference.block != block) continue;
            const proto::Block& message = *c.graph.blocks[reader].message;
            const auto take = [&](std::int32_t from, std::int64_t count) {
                least = std::max(least, from);
                most = static_cast<std::int32_t>(std::min<std::int64_t>(most, count - 1));
            };
            if (message.block_case() == proto::Block::kMaterialsMap && reference.field == ".material")
                take(0, message.materials_map().materials_size());
            else if (message.block_case() == proto::Block::kTransitionTiles && reference.field == ".material")
                take(0, message.transition_tiles().families());
            else if (message.block_case() == proto::Block::kReferenceTexture && reference.field == ".index")
                take(-1, c.blocks[c.named(message.reference_texture().patterns())].patterns->count);
            else
                return std::nullopt;
        }
    if (least > most || most >= most_values) return std::nullopt;
    return std::pair{least, most};
}

void find_support(Compilation& c) {
    if (c.plan.maps.empty()) return;
    for (const PendingReference& reference : c.references) {
        std::vector<bool> needed(c.nodes.size(), false);
        needed[reference.index] = true;
        const TransformNodes* transform = reference.transform.get();
        if (transform != nullptr)
            for (const std::size_t node : {transform->x, transform->y, transform->turn, transform->scale})
                needed[node] = true;
        int reach = 0;
        for (std::size_t node = 0; node < needed.size(); ++node)
            if (needed[node]) reach = std::max(reach, c.nodes[node].reach);
        for (std::size_t node = c.nodes.size(); node-- > 0;) {
            if (!needed[node]) continue;
            const CellNode& of = c.nodes[node];
            for (const std::size_t input : of.inputs) needed[input] = true;
            if (!of.map) continue;
            const std::string& name = c.graph.blocks[of.block].message->name();
            for (EditableMap& map : c.plan.maps) {
                if (map.block != name) continue;
                using Sampling = VaryingMap::Sampling;
                map.shown = true;
                map.cell_log2 = c.grids.at(of.grid).grid.cell_log2;
                map.reach = std::max(map.reach, reach);
                map.between_x |=
                    of.map->sampling == Sampling::dithered || of.map->sampling == Sampling::dithered_x;
                map.between_y |=
                    of.map->sampling == Sampling::dithered || of.map->sampling == Sampling::dithered_y;
                map.overflow |= transform != nullptr && transform->plan->overflow;
                map.scrolls |= reference.scroll.cells != 0;
            }
        }
    }
    // What is not bounded may have been folded away for what it holds now
    for (EditableMap& map : c.plan.maps) map.shown |= !map.map.bounded();
}

}  // namespace tessera
