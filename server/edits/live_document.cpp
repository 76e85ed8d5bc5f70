#include "server/edits/live_document.h"

#include <algorithm>
#include <ctime>
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
            to.clear_values();
            to.mutable_values()->Reserve(static_cast<int>(map.values.size()));
            map.values.for_spans([&to](std::span<const std::int32_t> values) {
                to.mutable_values()->Add(values.begin(), values.end());
            });
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
    next.settled = next.maps_known = false;
    next.edited = true;
    auto done = tessera::settle(next);
    if (done) *this = std::move(next);
    return done;
}

bool LiveDocument::same_ground(const LiveDocument& other) const {
    if (painted.size() != other.painted.size()) return false;
    for (const auto& [name, map] : painted) {
        const auto found = other.painted.find(name);
        if (found == other.painted.end() || !found->second.values.shares_all_with(map.values)) return false;
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

bool looks_at_maps(const proto::Edit& edit) {
    return std::any_of(edit.changes().begin(), edit.changes().end(),
                       [](const proto::Change& change) { return change.has_paint_map(); });
}

bool unsettles_scene(const proto::Edit& edit) {
    return std::any_of(edit.changes().begin(), edit.changes().end(), [](const proto::Change& change) {
        return change.has_set_parameter() || change.has_change_animation();
    });
}

namespace {

/// Whether a message begins with a field's path, or several: "block: …", "targets[1].x: …", "x, y: …".
bool begins_with_field(std::string_view detail) {
    const std::string_view begin = detail.substr(0, detail.find(':'));
    if (begin.size() == detail.size() || begin.empty()) return false;
    for (std::size_t i = 0; i < begin.size(); ++i) {
        const char c = begin[i];
        const bool in_path = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.' ||
                             c == '[' || c == ']' || c == ',';
        if (!in_path && !(c == ' ' && i > 0 && begin[i - 1] == ',')) return false;
    }
    return true;
}

}  // namespace

Error error_of_change(int i, const proto::Change& change, const Error& error) {
    const auto* kind = proto::Change::descriptor()->FindFieldByNumber(change.change_case());
    std::string name = "changes[" + std::to_string(i) + "]";
    if (kind != nullptr) name += "." + kind->name();
    return {error.code, name + (begins_with_field(error.detail) ? "." : ": ") + error.detail};
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
    document.settled = document.maps_known = true;
    return {};
}

namespace {

double thread_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) / 1e9;
}

}  // namespace

Result<DocumentEdit> apply_to_document(const proto::Edit& edit, const EditInstant& instant,
                                       LiveDocument& document, Planning planning, double planning_seconds) {
    DocumentEdit done;
    LiveDocument next = document;
    int plans = 0;
    const double begin = thread_seconds();
    for (int i = 0; i < edit.changes_size(); ++i) {
        const proto::Change& change = edit.changes(i);
        if (change.has_paint_map() && !next.maps_known &&
            (++plans > max_plans_of_edit ||
             (planning == Planning::in_time && thread_seconds() - begin > planning_seconds)))
            return error_of_change(i, change,
                                   {ErrorCode::invalid_input,
                                    "block: the edit plans the scene for the " + std::to_string(plans) +
                                        "th time, which takes too long; paint before setting parameters, or "
                                        "send several edits"});
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
        if (!made) return error_of_change(i, change, made.error());
        done.inverses.push_back(std::move(inverse));
    }
    if (planning == Planning::later) {
        // Of edits that were planned when they were accepted
    } else if (auto settled = settle(next); !settled)
        return Error{settled.error().code, "changes: " + settled.error().detail};
    std::reverse(done.inverses.begin(), done.inverses.end());
    document = std::move(next);
    return done;
}

}  // namespace tessera
