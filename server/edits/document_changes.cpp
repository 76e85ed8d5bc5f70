// Parameters, targets and the clock.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "server/edits/field_path.h"
#include "server/edits/live_document.h"
#include "shared/result/in_quotes.h"
#include "shared/wire/target_message.h"

namespace tessera {

namespace {

constexpr std::size_t most_boxes = 64;

Error wrong(const std::string& what) { return {ErrorCode::invalid_input, what}; }

std::shared_ptr<proto::Scene> copy_of(const LiveDocument& document) {
    return std::make_shared<proto::Scene>(*document.message);
}

void take(LiveDocument& document, std::shared_ptr<const proto::Scene> message) {
    document.message = std::move(message);
    document.edited = true;
}

Result<void> needs_document(const LiveDocument& document) {
    if (document.message) return {};
    return wrong("the scene takes edits of sprites only");
}

/// How far from a target what the blocks show may depend on it; −1: nothing looks at targets.
std::int64_t reach_of_targets(const proto::Scene& message) {
    std::int64_t far = -1, cell = 0;
    for (const proto::Block& block : message.pattern().blocks()) {
        if (block.animation_map().has_target_distance())
            far = std::max(far, std::int64_t{block.animation_map().target_distance().far_texels()});
        cell = std::max(cell, std::int64_t{block.virtual_tile_map().cell_texels()});
    }
    // From the middle of a cell, and what hangs over into the next
    return far < 0 ? -1 : far + 2 * cell;
}

void add_near(const proto::Target& target, std::int64_t reach, std::vector<TexelBox>& dirty) {
    if (reach < 0) return;
    std::vector<TexelBox> boxes;
    std::int64_t x = target.x(), y = target.y();
    const auto add = [&](std::int64_t to_x, std::int64_t to_y) {
        boxes.push_back({std::min(x, to_x) - reach, std::min(y, to_y) - reach, std::max(x, to_x) + reach + 1,
                         std::max(y, to_y) + reach + 1});
        x = to_x;
        y = to_y;
    };
    add(x, y);
    for (const proto::Target::Leg& leg : target.legs()) add(leg.x(), leg.y());
    if (!target.legs().empty()) add(target.x(), target.y());
    if (boxes.size() > most_boxes) {
        TexelBox all = boxes.front();
        for (const TexelBox& box : boxes) all = hull(all, box);
        boxes = {all};
    }
    dirty.insert(dirty.end(), boxes.begin(), boxes.end());
}

}  // namespace

Result<void> set_parameter(const proto::ParameterChange& change, LiveDocument& document,
                           proto::Change& inverse, std::vector<TexelBox>& dirty) {
    if (auto can = needs_document(document); !can) return can;
    auto message = copy_of(document);
    proto::ParameterChange& back = *inverse.mutable_set_parameter();
    back.set_block(change.block());
    back.set_field(change.field());
    Result<void> exchanged;
    if (change.block().empty()) {
        const auto& blocks = message->pattern().blocks();
        if (change.field() != "seed" || std::none_of(blocks.begin(), blocks.end(), [](const auto& block) {
                return lists_as_editable(block, "seed");
            }))
            return wrong("field: " + in_quotes(change.field()) + " is not editable; name a block");
        exchanged =
            exchange_field(*message->mutable_pattern(), "seed", change.value(), *back.mutable_value());
    } else {
        proto::Block* block = find_block(*message, change.block());
        if (block == nullptr) return wrong("block: there is no block " + in_quotes(change.block()));
        if (!lists_as_editable(*block, change.field()))
            return wrong("field: " + in_quotes(change.field()) + " of " + in_quotes(change.block()) +
                         " is not listed as editable by the scene file");
        const auto* kind = proto::Block::descriptor()->FindFieldByNumber(block->block_case());
        if (kind == nullptr) return wrong("block: " + in_quotes(change.block()) + " holds nothing");
        exchanged = exchange_field(*block->GetReflection()->MutableMessage(block, kind), change.field(),
                                   change.value(), *back.mutable_value());
    }
    if (!exchanged) return wrong("value: " + exchanged.error().detail);
    take(document, std::move(message));
    document.settled = document.maps_known = false;
    dirty.push_back(every_texel);
    return {};
}

Result<void> set_target(const proto::Target& target, LiveDocument& document, proto::Change& inverse,
                        std::vector<TexelBox>& dirty) {
    if (auto can = needs_document(document); !can) return can;
    const std::int64_t reach = reach_of_targets(*document.message);
    if (reach < 0)
        return wrong("nothing in the scene looks at targets; give an animation_map target_distance");
    auto message = copy_of(document);
    auto& targets = *message->mutable_targets();
    const auto same = std::find_if(targets.begin(), targets.end(),
                                   [&](const auto& old) { return old.id() == target.id(); });
    if (same == targets.end()) {
        inverse.mutable_remove_target()->set_id(target.id());
        *targets.Add() = target;
    } else {
        add_near(*same, reach, dirty);
        *inverse.mutable_set_target() = *same;
        *same = target;
    }
    if (const auto checked = target_of(target); !checked) return checked.error();
    if (const auto checked = targets_of(targets); !checked) return wrong("targets" + checked.error().detail);
    add_near(target, reach, dirty);
    take(document, std::move(message));
    return {};
}

Result<void> remove_target(std::uint64_t id, LiveDocument& document, proto::Change& inverse,
                           std::vector<TexelBox>& dirty) {
    if (auto can = needs_document(document); !can) return can;
    auto message = copy_of(document);
    auto& targets = *message->mutable_targets();
    const auto same =
        std::find_if(targets.begin(), targets.end(), [&](const auto& old) { return old.id() == id; });
    if (same == targets.end())
        return wrong("id: there is no target " + std::to_string(id) + "; somebody may have removed it");
    add_near(*same, reach_of_targets(*document.message), dirty);
    *inverse.mutable_set_target() = *same;
    targets.erase(same);
    take(document, std::move(message));
    return {};
}

Result<void> set_clock(const proto::ClockChange& change, const EditInstant& instant, LiveDocument& document,
                       proto::Change& inverse) {
    if (auto can = needs_document(document); !can) return can;
    if (!change.has_playing() && !change.has_step() && !change.has_steps_per_second())
        return wrong("says nothing; give it playing, step or steps_per_second");
    const double rate = change.steps_per_second();
    if (change.has_steps_per_second() && !(rate > 0 && rate <= 1000))
        return wrong("steps_per_second: is no number above 0 and at most 1000");
    if (change.has_step() && (change.step() < -max_step || change.step() > max_step))
        return wrong("step: is " + std::to_string(change.step()) + "; from -2^62 to 2^62");
    proto::ClockChange& back = *inverse.mutable_set_clock();
    SceneClock& clock = document.clock;
    clock = clock.sought(instant.at, instant.step);
    if (change.has_playing()) back.set_playing(clock.playing), clock.playing = change.playing();
    if (change.has_step()) back.set_step(clock.step), clock.step = change.step();
    if (change.has_steps_per_second())
        back.set_steps_per_second(clock.steps_per_second), clock.steps_per_second = rate;
    return {};
}

}  // namespace tessera
