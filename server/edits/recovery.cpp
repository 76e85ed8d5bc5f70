// What a scene is after a restart, and the snapshots that make restarts short.
#include <utility>

#include <spdlog/spdlog.h>

#include "server/edits/live_scene.h"
#include "server/journal/journal_wait.h"
#include "server/sprites/sprite_texture.h"

namespace tessera {

namespace {

/// After so many edits that a restart would plan the scene for there is a snapshot: somebody who paints and
/// drags a slider by turns must not cost a start of minutes.
constexpr std::size_t planned_edits_of_snapshot = 64;

Error of_history(const std::string& what) {
    return {ErrorCode::io_failure, "the journal's history cannot be read: " + what};
}

}  // namespace

Result<void> LiveScene::recover(Progress& progress) {
    const Revision head = journal_->status().head;
    const auto snapshot = newest_snapshot_and_wait(*journal_, head);
    if (!snapshot) return snapshot.error();
    if (*snapshot) {
        proto::LiveState state;
        if (!state.ParseFromString((*snapshot)->bytes)) return of_history("its snapshot is damaged");
        PositioningMap map{base_->sprites.overlap_layers()};
        for (const proto::SpritePlacement& placed : state.sprites()) {
            // A pattern that is gone since takes its sprites with it
            const auto sprite = sprite_of(placed, patterns());
            if (!sprite || !map.place(*sprite))
                spdlog::warn("scene {}: sprite {} does not fit the scene any more", id_, placed.id());
        }
        auto revisions = PageRevisions::load(state.page_revisions(), page_revision_bytes);
        if (!revisions) return of_history(revisions.error().detail);
        book_ = SpriteBook{std::move(map)};
        LiveDocument document = *document_;
        if (state.has_scene())
            if (auto restored = document.restore(state.scene()); !restored)
                spdlog::error(
                    "scene {}: what edits changed of its blocks does not fit the scene any more, and is "
                    "shown as its file says: {}",
                    id_, restored.error().detail);
        if (state.has_clock()) {
            document.clock.at = SceneClock::Time{std::chrono::milliseconds{state.clock().at_ms()}};
            document.clock.step = state.clock().step();
            document.clock.steps_per_second = state.clock().steps_per_second();
            document.clock.playing = state.clock().playing();
        }
        document_ = std::make_shared<const LiveDocument>(std::move(document));
        page_revisions_ = std::move(*revisions);
        head_ = (*snapshot)->revision;
    }
    if (head_ < head)
        if (auto replayed = replay(head, progress); !replayed) return replayed;
    publish();
    count_planned(changes_);
    changes_.clear();
    return {};
}

/// Each edit was planned when it was accepted: one plan behind them all is enough. Should that fail (the
/// scene's files or the server are others, or the disk had failed then), each is planned again, and what
/// cannot be shown left out.
Result<void> LiveScene::replay(Revision head, Progress& progress) {
    const SpriteBook book = book_;
    const auto document = document_;
    const Revision from = head_ + 1;
    for (const Planning planning : {Planning::later, Planning::now}) {
        book_ = book;
        document_ = document;
        head_ = from - 1;
        changes_.clear();
        const auto stopped = for_each_edit(*journal_, from, head, [&](const Edit& edit) {
            apply(edit, planning);
            if (edit.revision % 1024 == 0)
                progress.advance("replaying edits", static_cast<double>(edit.revision - from) /
                                                        static_cast<double>(head - from + 1));
            return !progress.stop().stop_requested();
        });
        if (stopped) return of_history("it ends before revision " + std::to_string(head));
        if (head_ != head) return Error{ErrorCode::cancelled, "stopped"};
        if (planning == Planning::now) break;
        LiveDocument planned = *document_;
        const auto settled = tessera::settle(planned);
        if (settled) {
            document_ = std::make_shared<const LiveDocument>(std::move(planned));
            break;
        }
        spdlog::warn("scene {}: what its edits make of it cannot be shown, so that each is looked at: {}",
                     id_, settled.error().detail);
    }
    return {};
}

/// The next edit of the journal. One that was possible when it was accepted, but is not after what the
/// journal put before it, changes nothing, here as after every restart.
void LiveScene::apply(const Edit& edit, Planning planning) {
    proto::Edit message;
    Change change{edit.revision, {}, nullptr};
    if (!message.ParseFromString(edit.bytes)) {
        spdlog::error("scene {}: the journal's edit {} cannot be read", id_, edit.revision);
        head_ = edit.revision;
        changes_.push_back(std::move(change));
        return;
    }
    LiveDocument document = *document_;
    // It was this step then: so the clock goes on over restarts
    if (document.clock.at < edit.accepted) document.clock = document.clock.sought(edit.accepted, edit.step);
    if (auto applied =
            apply_edit(message, patterns(), book_, {edit.accepted, edit.step}, document, planning)) {
        change.dirty = applied->dirty;
        for (Work& work : committing_)
            if (work.append.id == edit.id) work.applied = std::move(*applied);
        message.set_id(to_string(edit.id));
        change.edit = std::make_shared<proto::Edit>(std::move(message));
    } else {
        // A replay may not find that out
        snapshot_wanted_ = true;
        spdlog::warn("scene {}: edit {} changes nothing: {}", id_, edit.revision, applied.error().detail);
    }
    document_ = std::make_shared<const LiveDocument>(std::move(document));
    head_ = edit.revision;
    changes_.push_back(std::move(change));
}

proto::LiveState LiveScene::state_of(const PositioningMap& map, const LiveDocument& document,
                                     Revision revision) {
    proto::LiveState state;
    state.set_revision(revision);
    constexpr std::int64_t everywhere = std::int64_t{1} << 41;
    for (const Sprite& sprite : map.meeting({-everywhere, -everywhere, everywhere, everywhere}))
        write_sprite(sprite, *state.add_sprites());
    if (document.edited) *state.mutable_scene() = document.whole_message();
    proto::ClockState& clock = *state.mutable_clock();
    clock.set_at_ms(document.clock.at.time_since_epoch().count());
    clock.set_step(document.clock.step);
    clock.set_steps_per_second(document.clock.steps_per_second);
    clock.set_playing(document.clock.playing);
    return state;
}

proto::LiveState LiveScene::state() const {
    std::unique_lock lock{mutex_};
    const PositioningMap map = sprites_at_head();
    const auto document = document_;
    const Revision revision = head_;
    lock.unlock();
    return state_of(map, *document, revision);
}

/// Paint looks at maps, which have to be planned again if edits of blocks came before it.
void LiveScene::count_planned(const std::vector<Change>& changes) {
    for (const Change& change : changes) {
        if (!change.edit) continue;
        if (looks_at_maps(*change.edit) && std::exchange(replay_unsettled_, false)) ++planned_since_snapshot_;
        if (unsettles_scene(*change.edit)) replay_unsettled_ = true;
    }
}

void LiveScene::keep_snapshot() {
    const std::size_t many_plans = planned_edits_of_snapshot + book_.map().size() / 1024;
    if (keeps_snapshot_ || closing_) return;
    if (planned_since_snapshot_ < many_plans && !snapshot_wanted_ && !journal_->status().snapshot_due) return;
    keeps_snapshot_ = true;
    snapshot_wanted_ = false;
    planned_since_snapshot_ = 0;
    if (snapshots_.joinable()) snapshots_.join();
    snapshots_ = std::jthread{
        [this, map = book_.map(), document = document_, revisions = page_revisions_, revision = head_] {
            proto::LiveState state = state_of(map, *document, revision);
            state.set_page_revisions(revisions.save());
            journal_->keep_snapshot({revision, state.SerializeAsString()}, [this](Result<void> kept) {
                if (!kept) spdlog::error("scene {}: no snapshot: {}", id_, kept.error().detail);
                const std::lock_guard lock{mutex_};
                keeps_snapshot_ = false;
            });
        }};
}

}  // namespace tessera
