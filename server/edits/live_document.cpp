#include "server/edits/live_document.h"

#include <algorithm>
#include <utility>

#include "server/blocks/plan.h"

namespace tessera {

LiveDocument LiveDocument::of(const Scene& scene, SceneClock::Time now) {
    LiveDocument document;
    document.source = scene.document;
    if (scene.document) document.message = scene.document->message();
    document.maps = scene.editable_maps;
    document.extent = scene.extent;
    document.clock = {.at = now,
                      .step = 0,
                      .steps_per_second = scene.steps_per_second,
                      .loop_steps = scene.loop_steps,
                      .playing = true};
    return document;
}

proto::Scene LiveDocument::whole_message() const {
    proto::Scene whole = *message;
    for (const auto& [name, map] : painted) {
        proto::Block* block = find_block(whole, name);
        if (block == nullptr) continue;
        const auto write = [&map = map](auto& to) {
            to.clear_image();
            to.mutable_values()->Assign(map.values.begin(), map.values.end());
            to.set_width(static_cast<std::uint32_t>(map.width));
        };
        const auto write_explicit = [&](proto::ExplicitMap& to) {
            to.clear_blank_code();
            write(to);
        };
        if (block->has_explicit_indirection_map())
            write_explicit(*block->mutable_explicit_indirection_map());
        else if (block->has_areas_map())
            write_explicit(*block->mutable_areas_map());
        else if (block->has_dithered_areas_map())
            write_explicit(*block->mutable_dithered_areas_map()->mutable_areas());
        else if (block->has_pixel_map())
            write(*block->mutable_pixel_map());
    }
    return whole;
}

Result<void> LiveDocument::restore(const proto::Scene& whole) {
    if (!source)
        return Error{ErrorCode::invalid_input, "the scene's file has nothing left that edits change"};
    LiveDocument next = *this;
    next.message = std::make_shared<const proto::Scene>(whole);
    next.painted.clear();
    next.settled = false;
    next.edited = true;
    auto done = tessera::settle(next);
    if (done) *this = std::move(next);
    return done;
}

bool LiveDocument::same_ground(const LiveDocument& other) const {
    if (painted.size() != other.painted.size()) return false;
    for (const auto& [name, map] : painted) {
        const auto found = other.painted.find(name);
        if (found == other.painted.end() || found->second.values.data() != map.values.data()) return false;
    }
    if (message == other.message) return true;
    if (!message || !other.message) return false;
    // Only blocks are compiled
    return message->pattern().SerializeAsString() == other.message->pattern().SerializeAsString();
}

bool changes_document(const proto::Edit& edit) {
    return std::any_of(edit.changes().begin(), edit.changes().end(), [](const proto::Change& change) {
        switch (change.change_case()) {
            case proto::Change::kPlaceSprite:
            case proto::Change::kMoveSprite:
            case proto::Change::kRemoveSprite:
            case proto::Change::CHANGE_NOT_SET:
                return false;
            default:
                return true;
        }
    });
}

bool plans_scene(const proto::Edit& edit) {
    return std::any_of(edit.changes().begin(), edit.changes().end(), [](const proto::Change& change) {
        return change.has_set_parameter() || change.has_change_animation();
    });
}

std::string name_of_change(int i, const proto::Change& change) {
    const auto* kind = proto::Change::descriptor()->FindFieldByNumber(change.change_case());
    return "changes[" + std::to_string(i) + "]" + (kind != nullptr ? "." + kind->name() + "." : ": ");
}

proto::Block* find_block(proto::Scene& message, std::string_view name) {
    for (proto::Block& block : *message.mutable_pattern()->mutable_blocks())
        if (block.name() == name) return &block;
    return nullptr;
}

Result<void> settle(LiveDocument& document) {
    if (document.settled || !document.message) return {};
    if (document.message->has_pattern()) {
        auto plan = document.source->plan(*document.message, document.painted);
        if (!plan) return plan.error();
        document.maps = std::make_shared<const std::vector<EditableMap>>(std::move(plan->maps));
    }
    document.settled = true;
    return {};
}

Result<DocumentEdit> apply_to_document(const proto::Edit& edit, const EditInstant& instant,
                                       LiveDocument& document) {
    DocumentEdit done;
    LiveDocument next = document;
    int plans = 0;
    for (int i = 0; i < edit.changes_size(); ++i) {
        const proto::Change& change = edit.changes(i);
        if (change.has_paint_map() && !next.settled && ++plans > max_plans_of_edit)
            return Error{ErrorCode::invalid_input,
                         name_of_change(i, change) + "block: the edit plans the scene more than " +
                             std::to_string(max_plans_of_edit) +
                             " times; paint before setting parameters, or send several edits"};
        proto::Change inverse;
        Result<void> made;
        switch (change.change_case()) {
            case proto::Change::kPaintMap:
                made = paint_map(change.paint_map(), next, inverse, done.dirty);
                break;
            case proto::Change::kSetParameter:
                made = set_parameter(change.set_parameter(), next, inverse, done.dirty);
                break;
            case proto::Change::kChangeAnimation:
                made = change_animation(change.change_animation(), instant, next, inverse, done);
                break;
            case proto::Change::kSetTarget:
                made = set_target(change.set_target(), next, inverse, done.dirty);
                break;
            case proto::Change::kRemoveTarget:
                made = remove_target(change.remove_target().id(), next, inverse, done.dirty);
                break;
            case proto::Change::kSetClock:
                made = set_clock(change.set_clock(), instant, next, inverse);
                break;
            case proto::Change::kPlaceSprite:
            case proto::Change::kMoveSprite:
            case proto::Change::kRemoveSprite:
            case proto::Change::CHANGE_NOT_SET:
                continue;
        }
        if (!made) return Error{made.error().code, name_of_change(i, change) + made.error().detail};
        done.inverses.push_back(std::move(inverse));
    }
    if (auto settled = settle(next); !settled)
        return Error{settled.error().code, "changes: " + settled.error().detail};
    std::reverse(done.inverses.begin(), done.inverses.end());
    document = std::move(next);
    return done;
}

}  // namespace tessera
