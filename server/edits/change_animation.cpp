// Other parameters of an animation from a step on: temporal transitions (Lefebvre & Neyret 2003,
// section 3.4).
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "server/edits/live_document.h"
#include "shared/motion/transitions.h"
#include "shared/result/in_quotes.h"

namespace tessera {

namespace {

constexpr int max_changes = 64;

Error wrong(const std::string& what) { return {ErrorCode::invalid_input, what}; }

/// The time line of a map's sequence; nothing where the sequence is none that can be compiled.
std::optional<TimeLine> line_of(const proto::Scene& message, const std::string& sequence) {
    for (const proto::Block& block : message.pattern().blocks()) {
        if (block.name() != sequence || !block.has_animation_sequence()) continue;
        std::vector<std::uint32_t> steps;
        for (const auto& frame : block.animation_sequence().frames())
            steps.push_back(frame.has_steps() ? frame.steps() : 1);
        if (steps.empty() || steps.size() > 65536 || std::find(steps.begin(), steps.end(), 0u) != steps.end())
            return std::nullopt;
        return TimeLine{steps};
    }
    return std::nullopt;
}

template <class Message, class To>
void take_over(const Message& from, To& to) {
    if (from.has_phase()) *to.mutable_phase() = from.phase();
    if (from.has_rest()) *to.mutable_rest() = from.rest();
    if (from.has_density()) to.set_density(from.density());
}

/// What holds after the first `count` changes, each field said.
proto::AnimationMap::Change setting_after(const proto::AnimationMap& map, int count) {
    proto::AnimationMap::Change setting;
    setting.mutable_phase()->set_integer(0);
    setting.mutable_rest()->set_integer(0);
    setting.set_density(1);
    take_over(map, setting);
    for (int i = 0; i < count; ++i) take_over(map.changes(i), setting);
    return setting;
}

/// Forgets the oldest change, whose transition is over: what it said holds from always. What waited for it
/// would no longer: from now on each says the step at which it takes effect, and none that gave way is left.
void fold_oldest(proto::AnimationMap& map, const TimeLine& line) {
    ChangeTimes times{line};
    std::vector<proto::AnimationMap::Change> kept;
    for (const proto::AnimationMap::Change& change : map.changes()) {
        const ChangeTimes::Effect effect = times.add(change.step());
        if (!effect.replaces) kept.emplace_back();
        take_over(change, kept.back());
        kept.back().set_step(effect.step);
    }
    take_over(kept.front(), map);
    map.mutable_changes()->Assign(kept.begin() + 1, kept.end());
}

}  // namespace

Result<void> change_animation(const proto::AnimationChange& change, const EditInstant& instant,
                              LiveDocument& document, proto::Change& inverse, DocumentEdit& edit) {
    if (!document.message) return wrong("the scene takes edits of sprites only");
    auto message = std::make_shared<proto::Scene>(*document.message);
    proto::Block* block = find_block(*message, change.block());
    if (block == nullptr || !block->has_animation_map() ||
        std::find(block->editable().begin(), block->editable().end(), "animation") == block->editable().end())
        return wrong("block: " + in_quotes(change.block()) +
                     " is no animation map that the scene file lists as editable (\"animation\")");
    if (!change.has_phase() && !change.has_rest() && !change.has_density())
        return wrong("says nothing; give it phase, rest or density");
    if (change.has_density() && std::isnan(change.density())) return wrong("density: is no number");
    proto::AnimationMap& map = *block->mutable_animation_map();
    if (map.driver_case() != proto::AnimationMap::DRIVER_NOT_SET)
        return wrong("block: " + in_quotes(change.block()) + " is not driven by the clock");
    const Step step = change.has_step() ? change.step() : instant.step;
    if (step < -max_step || step > max_step)
        return wrong("step: is " + std::to_string(step) + "; from -2^62 to 2^62");
    const auto line = line_of(*message, map.sequence());
    if (!line) return wrong("block: has no animation sequence");

    // Behind those of its step, in front of later ones
    auto& changes = *map.mutable_changes();
    int at = 0;
    while (at < changes.size() && changes[at].step() <= step) ++at;
    ChangeTimes times{*line};
    for (int i = 0; i < at; ++i) times.add(changes[i].step());
    const proto::AnimationMap::Change before = setting_after(map, at);
    const ChangeTimes::Effect effect = times.effect_of(step);
    if (effect.replaces) {
        // The one before was still waiting: it gives way, but for what is not said anew
        changes[at - 1].set_step(step);
        take_over(change, changes[at - 1]);
    } else {
        if (changes.size() >= max_changes) {
            // By now every cell shows what the oldest said
            const bool over =
                at > 0 && add_steps(changes[0].step(), 2 * steps_between_changes(*line)) <= step;
            if (!over)
                return wrong("step: " + std::to_string(max_changes) +
                             " changes are still to come or on their way; take a later step");
            fold_oldest(map, *line);
            at = 0;
            while (at < changes.size() && changes[at].step() <= step) ++at;
        }
        proto::AnimationMap::Change& added = *changes.Add();
        added.set_step(step);
        take_over(change, added);
        for (int i = changes.size() - 1; i > at; --i) changes.SwapElements(i, i - 1);
    }

    proto::AnimationChange& back = *inverse.mutable_change_animation();
    back.set_block(change.block());
    if (change.has_phase()) *back.mutable_phase() = before.phase();
    if (change.has_rest()) *back.mutable_rest() = before.rest();
    if (change.has_density()) back.set_density(before.density());
    proto::Effect& told = edit.effects.emplace_back();
    told.set_block(change.block());
    told.set_step(effect.step);
    edit.dirty.push_back(every_texel);
    document.message = std::move(message);
    document.edited = true;
    document.settled = document.maps_known = false;
    return {};
}

}  // namespace tessera
