#include "server/history/undo.h"

#include <algorithm>
#include <future>
#include <optional>
#include <string>
#include <utility>

#include <google/protobuf/util/message_differencer.h>

#include "server/edits/live_scene.h"
#include "server/history/document_difference.h"
#include "server/history/past_journal.h"
#include "server/history/scene_state.h"
#include "server/journal/journal_wait.h"
#include "shared/revisions/edit_id.h"

namespace tessera {

namespace {

using google::protobuf::util::MessageDifferencer;

constexpr std::size_t max_edit_bytes = (std::size_t{64} << 10) - 1024;  ///< With room for the author.

struct Difference {
    std::vector<proto::Change> removals, moves, placements;
};

/// The move that makes `now` `then`; none if a move cannot.
std::optional<proto::Change> move_between(const proto::SpritePlacement& now,
                                          const proto::SpritePlacement& then) {
    proto::SpritePlacement moved = now;
    proto::Change change;
    proto::SpriteMove& move = *change.mutable_move_sprite();
    move.set_id(now.id());
    const double scale = then.has_scale() ? then.scale() : 1;
    if (now.x() != then.x()) move.set_x(then.x());
    if (now.y() != then.y()) move.set_y(then.y());
    if ((now.has_scale() ? now.scale() : 1) != scale) move.set_scale(scale);
    if (now.turn() != then.turn()) move.set_turn(then.turn());
    if (now.order() != then.order()) move.set_order(then.order());
    if (now.pattern() != then.pattern()) move.set_pattern(then.pattern());
    moved.set_x(then.x());
    moved.set_y(then.y());
    moved.set_turn(then.turn());
    moved.set_order(then.order());
    moved.set_pattern(then.pattern());
    moved.clear_scale();
    if (then.has_scale()) moved.set_scale(then.scale());
    if (!MessageDifferencer::Equals(moved, then)) return std::nullopt;
    return change;
}

proto::Change removal(std::uint64_t id) {
    proto::Change change;
    change.mutable_remove_sprite()->set_id(id);
    return change;
}

proto::Change placement(const proto::SpritePlacement& sprite) {
    proto::Change change;
    *change.mutable_place_sprite() = sprite;
    return change;
}

/// What makes the sprites `now` those of `then`; both by id. Without `moves`, whatever differs is taken away
/// first, so that nothing is ever in the way of what was there.
Difference difference(const SpriteList& now, const SpriteList& then, bool moves) {
    Difference found;
    auto a = now.begin();
    auto b = then.begin();
    while (a != now.end() || b != then.end()) {
        if (b == then.end() || (a != now.end() && a->id() < b->id())) {
            found.removals.push_back(removal((a++)->id()));
        } else if (a == now.end() || b->id() < a->id()) {
            found.placements.push_back(placement(*b++));
        } else {
            if (!MessageDifferencer::Equals(*a, *b)) {
                auto move = moves ? move_between(*a, *b) : std::nullopt;
                if (move) {
                    found.moves.push_back(std::move(*move));
                } else {
                    found.removals.push_back(removal(a->id()));
                    found.placements.push_back(placement(*b));
                }
            }
            ++a, ++b;
        }
    }
    return found;
}

/// As few edits as the limits allow.
std::vector<proto::Edit> packed(std::vector<proto::Change> changes, Revision head) {
    std::vector<proto::Edit> edits;
    std::size_t bytes = 0;
    for (proto::Change& change : changes) {
        const std::size_t more = change.ByteSizeLong() + 8;
        if (edits.empty() || edits.back().changes_size() == max_changes || bytes + more > max_edit_bytes) {
            edits.emplace_back().set_base_revision(head++);
            bytes = 0;
        }
        bytes += more;
        *edits.back().add_changes() = std::move(change);
    }
    return edits;
}

EditOutcome edit_and_wait(LiveScene& scene, proto::Edit edit) {
    edit.set_id(to_string(random_edit_id()));
    std::promise<EditOutcome> outcome;
    scene.edit(std::move(edit), [&](EditOutcome how) { outcome.set_value(std::move(how)); });
    return outcome.get_future().get();
}

Result<std::unique_ptr<LiveScene>> scene_at(const ScenePtr& ground, Journal& journal, Revision revision,
                                            Progress& progress) {
    auto past = PastJournal::at(journal, revision);
    if (!past) return past.error();
    return LiveScene::open(ground, std::move(*past), progress);
}

/// Why the edits do not make the scene of now that of then; nothing if they do.
Result<void> try_out(const ScenePtr& ground, Journal& journal, const Undo& undo, const SceneState& then,
                     Progress& progress) {
    auto scene = scene_at(ground, journal, undo.head, progress);
    if (!scene) return scene.error();
    for (const proto::Edit& edit : undo.edits) {
        const EditOutcome outcome = edit_and_wait(**scene, edit);
        if (const auto* refusal = std::get_if<EditRefusal>(&outcome))
            return Error{ErrorCode::invalid_input, refusal->detail};
    }
    if (alike(state_of(**scene), then)) return {};
    return Error{ErrorCode::invalid_input, "something that has changed since cannot be changed back"};
}

}  // namespace

Result<Undo> plan_undo(const ScenePtr& ground, Journal& journal, Revision revision, Progress& progress) {
    Undo undo;
    undo.head = journal.status().head;
    SceneState now, then;
    {
        auto scene = scene_at(ground, journal, revision, progress);
        if (!scene) return scene.error();
        then = state_of(**scene);
    }
    {
        auto scene = scene_at(ground, journal, undo.head, progress);
        if (!scene) return scene.error();
        now = state_of(**scene);
        undo.fingerprint = (*scene)->now()->fingerprint;
    }
    const auto others = document_difference(now, then, journal, revision);
    if (!others) return others.error();
    Error why;
    for (const bool moves : {true, false}) {
        std::vector<proto::Change> changes = *others;
        Difference sprites = difference(now.sprites, then.sprites, moves);
        for (auto* list : {&sprites.removals, &sprites.moves, &sprites.placements})
            std::move(list->begin(), list->end(), std::back_inserter(changes));
        undo.edits = packed(std::move(changes), undo.head);
        const auto tried = try_out(ground, journal, undo, then, progress);
        if (tried) return undo;
        why = tried.error();
        if (why.code != ErrorCode::invalid_input) break;
    }
    return why;
}

}  // namespace tessera
