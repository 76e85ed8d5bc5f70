// Animation Map (3.4): which of its settings hold from which step on, and where they come from.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "server/blocks/compilation.h"

namespace tessera {

namespace {

constexpr int max_changes = 64;

/// The input of a node, added if it is new.
int input_of(std::vector<std::size_t>& inputs, std::size_t node) {
    const auto at = std::find(inputs.begin(), inputs.end(), node) - inputs.begin();
    if (at == std::ssize(inputs)) inputs.push_back(node);
    return static_cast<int>(at);
}

/// A field of steps. Adds its node to `inputs` if it is no constant.
Result<AnimationSteps> read_steps(Compilation& c, std::size_t block, std::string_view field,
                                  const proto::Value& value, std::int64_t least,
                                  std::vector<std::size_t>& inputs) {
    const std::string range = "; from " + std::to_string(least) + " on";
    switch (value.value_case()) {
        case proto::Value::VALUE_NOT_SET:
            return AnimationSteps{};
        case proto::Value::kInteger:
            if (value.integer() < least)
                return c.error(block, field, "is " + std::to_string(value.integer()) + range);
            return AnimationSteps{value.integer()};
        case proto::Value::kNumber:
            if (!(std::abs(value.number()) <= 1e15) || value.number() < static_cast<double>(least))
                return c.error(block, field,
                               "is " + number_text(value.number()) + "; a number of steps up to 1e15" +
                                   (least == 0 ? ", from 0 on" : ""));
            return AnimationSteps{static_cast<std::int64_t>(std::floor(value.number()))};
        case proto::Value::kBlock:
            break;
    }
    const std::size_t node = c.blocks[c.named(value.block())].node;
    const CellNode& from = c.nodes[node];
    const bool blank = least == 0 && !from.number && from.least == -1;  // For ever
    if (from.least < least && !blank) return c.error(block, field, range_text(from) + range);
    if (from.steps)
        return c.error(block, field, "is animated itself, which would let cells jump; give it `changes`");
    const int input = input_of(inputs, node);
    if (inputs.size() > max_inputs)
        return c.error(block, field,
                       "is one of more than " + std::to_string(max_inputs) +
                           " blocks that phases and rests come from; let changes share some");
    return AnimationSteps{0, input, from.number ? 16 : 0};
}

Result<std::uint64_t> read_density(Compilation& c, std::size_t block, const std::string& field,
                                   double density) {
    if (std::isinf(density) && density > 0) return endless_density;
    if (!(density >= 0 && density <= 32767))
        return c.error(block, field,
                       "is " + number_text(density) + "; a number from 0 to 32767, or Infinity");
    return static_cast<std::uint64_t>(to_number(density));
}

/// `setting` with what a message says.
template <class Message>
Result<AnimationSetting> read_setting(Compilation& c, std::size_t block, const std::string& field,
                                      const Message& message, AnimationSetting setting,
                                      std::vector<std::size_t>& inputs) {
    if (message.has_density()) {
        const auto density = read_density(c, block, field + ".density", message.density());
        if (!density) return density.error();
        setting.density = *density;
    }
    if (message.has_phase()) {
        const auto phase = read_steps(c, block, field + ".phase", message.phase(),
                                      std::numeric_limits<std::int64_t>::min(), inputs);
        if (!phase) return phase.error();
        setting.phase = *phase;
    }
    if (message.has_rest()) {
        const auto rest = read_steps(c, block, field + ".rest", message.rest(), 0, inputs);
        if (!rest) return rest.error();
        setting.rest = *rest;
    }
    return setting;
}

/// Whether its cells ever show another frame.
bool moves(const AnimationSetting& setting) {
    return setting.rest.input >= 0 || setting.rest.constant < endless_rest;
}

}  // namespace

Result<void> compile_animation_map(Compilation& c, std::size_t block) {
    const proto::AnimationMap& message = c.graph.blocks[block].message->animation_map();
    if (message.driver_case() != proto::AnimationMap::DRIVER_NOT_SET)
        return compile_driven_animation(c, block);
    const auto& frames = c.blocks[c.named(message.sequence())].frames;
    CellNode node;
    const auto first = read_setting(c, block, "", message, {}, node.inputs);
    if (!first) return first.error();
    if (message.changes_size() > max_changes)
        return c.error(
            block, ".changes",
            "lists " + std::to_string(message.changes_size()) + "; at most " + std::to_string(max_changes));
    std::vector<AnimationSetting> settings{*first};
    ChangeTimes times{frames->line};
    AnimationSetting last = *first;
    for (int i = 0; i < message.changes_size(); ++i) {
        const proto::AnimationMap::Change& change = message.changes(i);
        const std::string field = ".changes[" + std::to_string(i) + "]";
        if (change.step() < -max_step || change.step() > max_step)
            return c.error(block, field + ".step",
                           "is " + std::to_string(change.step()) + "; from -2^62 to 2^62");
        if (i > 0 && change.step() < message.changes(i - 1).step())
            return c.error(block, field + ".step",
                           "is " + std::to_string(change.step()) + ", before the change above it; sort them");
        const auto setting = read_setting(c, block, field, change, last, node.inputs);
        if (!setting) return setting.error();
        last = *setting;
        const auto effect = times.add(change.step());
        if (effect.replaces) settings.pop_back();
        settings.push_back(last);
        if (effect.step != change.step())
            c.notes[block] += (c.notes[block].empty() ? "" : ", ") + ("change " + std::to_string(i)) +
                              " waits until step " + std::to_string(effect.step);
    }
    for (AnimationSetting& setting : settings)
        if (setting.rest.input < 0) setting.rest.constant = rest_of(setting.rest.constant, setting.density);

    node.least = frames->least;
    node.most = frames->most;
    node.steps = frames->patterns.size() > 1 && std::any_of(settings.begin(), settings.end(), moves);
    if (!node.steps) node.least = node.most = frames->patterns.front(), node.inputs.clear();
    node.animation = std::make_shared<AnimationOp>(
        frames, std::move(settings), std::vector<Step>(times.steps().begin(), times.steps().end()));
    node.op = node.animation;
    if (auto added = c.add_node(block, std::move(node)); !added) return added.error();
    return {};
}

}  // namespace tessera
