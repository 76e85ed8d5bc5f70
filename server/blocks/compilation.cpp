#include "server/blocks/compilation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/blocks/simple_ops.h"
#include "shared/math/hash.h"

namespace tessera {

std::string number_text(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

std::int32_t to_number(double value) noexcept {
    return static_cast<std::int32_t>(std::floor(value * number_one + 0.5));
}

std::string range_text(const CellNode& node) {
    const auto text = [&](std::int32_t value) {
        return node.number ? number_text(static_cast<double>(value) / number_one) : std::to_string(value);
    };
    return node.constant() ? "is " + text(node.least)
                           : "can be from " + text(node.least) + " to " + text(node.most);
}

std::size_t Compilation::add_constant(std::int32_t value, bool number) {
    CellNode node;
    node.op = make_constant_op(value);
    node.number = number;
    node.least = node.most = value;
    nodes.push_back(std::move(node));
    return nodes.size() - 1;
}

Result<std::size_t> Compilation::add_node(std::size_t block, CellNode node) {
    node.block = block;
    bool constant_inputs = !node.draw && !node.map;
    for (std::size_t i = 0; i < node.inputs.size(); ++i) {
        const CellNode& input = nodes[node.inputs[i]];
        constant_inputs &= input.constant();
        node.steps |= input.steps;
        node.reach =
            std::max(node.reach, input.reach + (node.corners && i == 0 && !input.constant() ? 1 : 0));
        if (input.grid == no_block) continue;
        if (node.grid != no_block && node.grid != input.grid)
            return error(block, "",
                         "its inputs live on different grids, \"" + graph.blocks[node.grid].message->name() +
                             "\" and \"" + graph.blocks[input.grid].message->name() +
                             "\"; give all of them one grid");
        node.grid = input.grid;
    }
    if (node.reach > max_reach)
        return error(block, ".material",
                     "reads corners of corners more than " + std::to_string(max_reach) +
                         " deep; take fewer transition tiles in a row");
    if (constant_inputs && !node.steps && node.op) {
        // All inputs are constant: so is the block
        std::vector<std::int32_t> values;
        for (std::size_t i = 0; i < node.inputs.size(); ++i)
            values.insert(values.end(), node.corners && i == 0 ? 4 : 1, nodes[node.inputs[i]].least);
        std::array<const std::int32_t*, max_inputs> in{};
        for (std::size_t i = 0; i < values.size(); ++i) in[i] = &values[i];
        std::int32_t value = 0;
        node.op->run({.count = 1}, in.data(), &value);
        node.least = node.most = value;
    }
    if (node.constant()) {
        node.op = make_constant_op(node.least);
        node.inputs.clear();
        node.draw.reset();
        node.map.reset();
        node.animation.reset();
        node.driven.reset();
        node.corners = false;
        node.reach = 0;
        notes[block] = "folded to " + (node.number ? number_text(static_cast<double>(node.least) / number_one)
                                                   : std::to_string(node.least));
    }
    nodes.push_back(std::move(node));
    blocks[block].node = nodes.size() - 1;
    return nodes.size() - 1;
}

Result<std::size_t> Compilation::integer(std::size_t block, std::string_view field, const proto::Value& value,
                                         std::int32_t fallback) {
    switch (value.value_case()) {
        case proto::Value::kBlock:
            return blocks[named(value.block())].node;
        case proto::Value::kInteger:
            if (value.integer() < -1 || value.integer() > 0x7fffffff)
                return error(block, field,
                             "is " + std::to_string(value.integer()) + "; an integer from -1 to 2147483647");
            return add_constant(static_cast<std::int32_t>(value.integer()), false);
        case proto::Value::kNumber:
            return error(
                block, field,
                "is the number " + number_text(value.number()) + "; an integer is needed: {\"integer\": …}");
        case proto::Value::VALUE_NOT_SET:
            break;
    }
    return add_constant(fallback, false);
}

Result<std::size_t> Compilation::number(std::size_t block, std::string_view field, const proto::Value& value,
                                        double fallback, double least, double most) {
    std::size_t node = no_block;
    const std::string range = "; a number from " + number_text(least) + " to " + number_text(most);
    const auto constant = [&](double given) -> Result<std::size_t> {
        if (!(given >= least && given <= most))
            return error(block, field, "is " + number_text(given) + range);
        return add_constant(to_number(given), true);
    };
    switch (value.value_case()) {
        case proto::Value::VALUE_NOT_SET:
            return constant(fallback);
        case proto::Value::kNumber:
            return constant(value.number());
        case proto::Value::kInteger:
            return constant(static_cast<double>(value.integer()));
        case proto::Value::kBlock:
            node = blocks[named(value.block())].node;
            break;
    }
    const CellNode& source = nodes[node];
    const double unit = source.number ? 1.0 / number_one : 1.0;
    if (source.least * unit < least || source.most * unit > most)
        return error(block, field, range_text(source) + range);
    if (source.number) return node;
    // Integers as numbers: a node more, for the same block
    CellNode scaled;
    scaled.op = make_scale_op(number_one);
    scaled.inputs = {node};
    scaled.number = true;
    scaled.least = source.least * number_one;
    scaled.most = source.most * number_one;
    const std::size_t kept = blocks[block].node;
    const auto added = add_node(block, std::move(scaled));
    blocks[block].node = kept;
    return added;
}

Result<std::vector<std::size_t>> Compilation::shown(
    std::size_t block, const google::protobuf::RepeatedPtrField<std::string>& names) {
    std::vector<std::size_t> textures;
    std::size_t weight = 1;
    for (const std::string& name : names) {
        const Compiled& part = blocks[named(name)];
        textures.push_back(part.texture);
        weight += part.weight;
    }
    if (weight > max_texture_weight)
        return error(block, ".textures",
                     "show " + std::to_string(weight) +
                         " textures, those inside of others counted each time; at most " +
                         std::to_string(max_texture_weight));
    blocks[block].weight = weight;
    return textures;
}

std::uint64_t Compilation::stream_key(std::size_t block, std::uint32_t asked, std::size_t grid) const {
    const std::uint64_t own = asked != 0 ? stream("pattern stream", asked)
                                         : stream("pattern block " + graph.blocks[block].message->name());
    return mix(own ^ stream("grid " + graph.blocks[grid].message->name()));
}

}  // namespace tessera
