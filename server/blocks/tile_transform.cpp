// Tile Transform (3.2, figures 4 and 5): "this block allows to scale, rotate or translate a pattern within
// its virtual tile map cell". Turns and scales are rounded to a few steps, so that each instance is rendered
// once.
#include <algorithm>

#include "server/blocks/compilation.h"

namespace tessera {

std::uint8_t LookSteps::turn(std::int32_t value) const noexcept {
    const std::int64_t nearest = (std::int64_t{value} * turns + number_one / 2) / number_one;
    return static_cast<std::uint8_t>((nearest - first_turn) % turns);
}

std::uint8_t LookSteps::scale(std::int32_t value) const noexcept {
    if (scales <= 1) return 0;
    const std::int64_t span = std::int64_t{scale_most} - scale_least;
    return static_cast<std::uint8_t>(((std::int64_t{value} - scale_least) * (scales - 1) * 2 + span) /
                                     (2 * span));
}

Result<void> compile_tile_transform(Compilation& c, std::size_t block) {
    const proto::TileTransform& message = c.graph.blocks[block].message->tile_transform();
    const std::uint32_t turns = message.turns() == 0 ? 32 : message.turns();
    const std::uint32_t scales = message.scales() == 0 ? 4 : message.scales();
    if (turns > 256) return c.error(block, ".turns", "is " + std::to_string(turns) + "; from 1 to 256");
    if (scales > 64) return c.error(block, ".scales", "is " + std::to_string(scales) + "; from 1 to 64");

    TransformNodes nodes;
    nodes.path = c.graph.blocks[block].path;
    nodes.grid = c.named(message.grid());
    const struct {
        std::string_view field;
        const proto::Value& value;
        double fallback, least, most;
        std::size_t& node;
    } fields[] = {{".x", message.x(), 0.5, 0, 1, nodes.x},
                  {".y", message.y(), 0.5, 0, 1, nodes.y},
                  {".scale", message.scale(), 1, 1.0 / 64, 4, nodes.scale},
                  {".turn", message.turn(), 0, 0, 1, nodes.turn}};
    for (const auto& field : fields) {
        const auto node = c.number(block, field.field, field.value, field.fallback, field.least, field.most);
        if (!node) return node.error();
        field.node = *node;
        if (c.nodes[*node].grid != no_block && c.nodes[*node].grid != nodes.grid)
            return c.error(block, field.field,
                           "lives on the grid \"" + c.graph.blocks[c.nodes[*node].grid].message->name() +
                               "\", the transform on \"" + message.grid() + "\"; give both one grid");
    }

    auto plan = std::make_shared<TransformPlan>();
    plan->overflow = message.overflow();
    const CellNode& scale = c.nodes[nodes.scale];
    // Those turns only that occur
    const CellNode& turn = c.nodes[nodes.turn];
    nodes.steps = {static_cast<std::int32_t>(turns), 0,
                   static_cast<std::int32_t>(scale.constant() ? 1 : scales), scale.least, scale.most};
    const std::int64_t first = (std::int64_t{turn.least} * turns + number_one / 2) / number_one;
    const std::int64_t last = (std::int64_t{turn.most} * turns + number_one / 2) / number_one;
    nodes.steps.first_turn = static_cast<std::int32_t>(last - first >= turns ? 0 : first);
    for (std::int32_t i = 0; i < nodes.steps.turns && i <= last - first; ++i)
        plan->turns.push_back(static_cast<double>((nodes.steps.first_turn + i) % nodes.steps.turns) / turns);
    const double least = static_cast<double>(scale.least) / number_one;
    const double span = static_cast<double>(std::int64_t{scale.most} - scale.least) / number_one;
    if (scale.constant())
        plan->scales = {least};
    else if (scales == 1)
        plan->scales = {least + span / 2};
    else
        for (std::uint32_t i = 0; i < scales; ++i) plan->scales.push_back(least + span * i / (scales - 1));
    c.notes[block] = std::to_string(plan->turns.size()) + " turns, " + std::to_string(plan->scales.size()) +
                     " scales" + (plan->overflow ? ", overflow" : "");
    nodes.plan = std::move(plan);
    c.blocks[block].transform = std::make_shared<const TransformNodes>(std::move(nodes));
    return {};
}

}  // namespace tessera
