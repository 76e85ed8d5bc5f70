#include "server/history/document_difference.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <string>
#include <utility>

#include <google/protobuf/util/message_differencer.h>

#include "server/edits/field_path.h"
#include "server/edits/live_document.h"
#include "server/journal/journal_wait.h"

namespace tessera {

namespace {

using google::protobuf::util::MessageDifferencer;

constexpr std::int64_t max_entries =
    15'000;  ///< Of one change: two bytes each, so that some fit into an edit.

/// Paints the entries of `then` over the box of those that differ.
void add_paints(const EditableMap& now, const EditableMap& then, std::vector<proto::Change>& changes) {
    const std::int64_t width = now.map.width, height = now.map.height;
    if (then.map.width != width || then.map.height != height) return;
    if (now.map.values.shares_all_with(then.map.values)) return;
    std::int64_t x0 = width, x1 = 0, y0 = height, y1 = 0;
    for (std::int64_t y = 0; y < height; ++y)
        for (std::int64_t x = 0; x < width; ++x) {
            const auto at = static_cast<std::size_t>(y * width + x);
            if (now.map.values[at] == then.map.values[at]) continue;
            x0 = std::min(x0, x), x1 = std::max(x1, x + 1);
            y0 = std::min(y0, y), y1 = y + 1;
        }
    const std::int64_t columns = std::min(x1 - x0, max_entries);
    if (columns <= 0) return;
    const std::int64_t rows = std::max<std::int64_t>(1, max_entries / columns);
    for (std::int64_t top = y0; top < y1; top += rows)
        for (std::int64_t left = x0; left < x1; left += columns) {
            const std::int64_t right = std::min(left + columns, x1), bottom = std::min(top + rows, y1);
            proto::MapPaint& paint = *changes.emplace_back().mutable_paint_map();
            paint.set_block(now.block);
            paint.set_x(left);
            paint.set_y(top);
            paint.set_width(static_cast<std::uint32_t>(right - left));
            paint.set_height(static_cast<std::uint32_t>(bottom - top));
            std::string& values = *paint.mutable_values();
            for (std::int64_t y = top; y < bottom; ++y)
                for (std::int64_t x = left; x < right; ++x) {
                    const auto value =
                        static_cast<std::uint32_t>(then.map.values[static_cast<std::size_t>(y * width + x)]);
                    values += static_cast<char>(value & 0xff);
                    values += static_cast<char>(value >> 8 & 0xff);
                }
        }
}

/// What edits since have named.
struct Named {
    std::set<std::pair<std::string, std::string>> fields;  ///< Of which block.
    std::set<std::string> animations;
};

Result<Named> named_since(Journal& journal, Revision revision) {
    Named named;
    const Revision head = journal.status().head;
    const auto ended = for_each_edit(journal, revision + 1, head, [&](const Edit& edit) {
        proto::Edit message;
        if (!message.ParseFromString(edit.bytes)) return true;
        for (const proto::Change& change : message.changes()) {
            if (change.has_set_parameter())
                named.fields.emplace(change.set_parameter().block(), change.set_parameter().field());
            if (change.has_change_animation()) named.animations.insert(change.change_animation().block());
        }
        return true;
    });
    if (ended) return Error{ErrorCode::io_failure, "the journal's history cannot be read"};
    return named;
}

/// A field's value; nothing if there is no such field.
std::optional<proto::Value> field_of(proto::Scene& scene, const std::string& name, const std::string& path) {
    google::protobuf::Message* holder = scene.mutable_pattern();
    if (!name.empty()) {
        proto::Block* const block = find_block(scene, name);
        const auto* kind =
            block == nullptr ? nullptr : proto::Block::descriptor()->FindFieldByNumber(block->block_case());
        if (kind == nullptr) return std::nullopt;
        holder = block->GetReflection()->MutableMessage(block, kind);
    }
    proto::Value old;
    if (!exchange_field(*holder, path, {}, old)) return std::nullopt;
    return old;
}

void add_fields(const Named& named, const SceneState& now, const SceneState& then,
                std::vector<proto::Change>& changes) {
    for (const auto& [block, field] : named.fields) {
        proto::Scene before = now.document, after = then.document;
        const auto old = field_of(before, block, field), wanted = field_of(after, block, field);
        if (!old || !wanted || MessageDifferencer::Equals(*old, *wanted)) continue;
        proto::ParameterChange& change = *changes.emplace_back().mutable_set_parameter();
        change.set_block(block);
        change.set_field(field);
        *change.mutable_value() = *wanted;
    }
}

/// About which step the clock shows.
std::int64_t step_now(const proto::ClockState& clock) {
    if (!clock.playing()) return clock.step();
    const auto now = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::system_clock::now().time_since_epoch());
    return clock.step() + static_cast<std::int64_t>(static_cast<double>(now.count() - clock.at_ms()) *
                                                    clock.steps_per_second() / 1000);
}

void add_animations(const Named& named, const SceneState& now, const SceneState& then,
                    std::vector<proto::Change>& changes) {
    for (const std::string& name : named.animations) {
        proto::Scene before = now.document, after = then.document;
        const proto::Block *old = find_block(before, name), *wanted = find_block(after, name);
        if (old == nullptr || wanted == nullptr || MessageDifferencer::Equals(*old, *wanted)) continue;
        proto::AnimationChange& change = *changes.emplace_back().mutable_change_animation();
        change.set_block(name);
        change.mutable_phase()->set_integer(0);
        change.mutable_rest()->set_integer(0);
        change.set_density(1);
        const auto take = [&](const auto& from) {
            if (from.has_phase()) *change.mutable_phase() = from.phase();
            if (from.has_rest()) *change.mutable_rest() = from.rest();
            if (from.has_density()) change.set_density(from.density());
        };
        // Behind all that is still to come
        std::int64_t last = step_now(now.clock);
        for (const auto& each : old->animation_map().changes())
            if (each.step() > last) change.set_step(last = each.step());
        take(wanted->animation_map());
        for (const auto& each : wanted->animation_map().changes()) take(each);
    }
}

void add_targets(const SceneState& now, const SceneState& then, std::vector<proto::Change>& changes) {
    const auto find = [](const SceneState& state, std::uint64_t id) {
        const auto& targets = state.document.targets();
        const auto found = std::find_if(targets.begin(), targets.end(),
                                        [&](const auto& target) { return target.id() == id; });
        return found == targets.end() ? nullptr : &*found;
    };
    for (const proto::Target& target : now.document.targets())
        if (find(then, target.id()) == nullptr)
            changes.emplace_back().mutable_remove_target()->set_id(target.id());
    for (const proto::Target& target : then.document.targets())
        if (const auto* old = find(now, target.id());
            old == nullptr || !MessageDifferencer::Equals(*old, target))
            *changes.emplace_back().mutable_set_target() = target;
}

void add_clock(const SceneState& now, const SceneState& then, std::vector<proto::Change>& changes) {
    proto::ClockChange change;
    if (now.clock.playing() != then.clock.playing()) change.set_playing(then.clock.playing());
    if (now.clock.steps_per_second() != then.clock.steps_per_second())
        change.set_steps_per_second(then.clock.steps_per_second());
    // One that runs has gone on since
    if (!then.clock.playing() && now.clock.step() != then.clock.step()) change.set_step(then.clock.step());
    if (change.ByteSizeLong() > 0) *changes.emplace_back().mutable_set_clock() = std::move(change);
}

}  // namespace

Result<std::vector<proto::Change>> document_difference(const SceneState& now, const SceneState& then,
                                                       Journal& journal, Revision then_revision) {
    const auto named = named_since(journal, then_revision);
    if (!named) return named.error();
    std::vector<proto::Change> changes;
    add_fields(*named, now, then, changes);
    if (now.maps && then.maps)
        for (const EditableMap& map : *now.maps)
            for (const EditableMap& old : *then.maps)
                if (old.block == map.block) add_paints(map, old, changes);
    add_animations(*named, now, then, changes);
    add_targets(now, then, changes);
    add_clock(now, then, changes);
    return changes;
}

}  // namespace tessera
