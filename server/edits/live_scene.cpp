#include "server/edits/live_scene.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <spdlog/spdlog.h>

#include "server/journal/journal_wait.h"
#include "server/journal/judge.h"
#include "server/pattern/targeted_texture.h"
#include "server/sprites/sprite_texture.h"
#include "shared/math/hash.h"
#include "shared/wire/target_message.h"

namespace tessera {

namespace {

constexpr std::size_t most_in_commit = 512;
/// The last of which is waited for.
constexpr int most_rebases = 4;
constexpr std::size_t most_in_group = LiveScene::max_in_group;
EditRefusal refusal_of(const Refused& refused, Revision head) {
    using Why = EditRefusal::Why;
    Why why = Why::unavailable;
    switch (refused.why) {
        case RefusalReason::other_content:
            why = Why::other_content;
            break;
        case RefusalReason::too_large:
            why = Why::wrong;
            break;
        case RefusalReason::outside_horizon:
            why = Why::too_old;
            break;
        case RefusalReason::overloaded:
            why = Why::overloaded;
            break;
        case RefusalReason::full:
        case RefusalReason::unavailable:
            break;
    }
    return {why, refused.detail, head};
}

/// What is not possible now may have been accepted once and be forgotten since: then it is refused for that.
std::optional<EditRefusal> beyond_horizon(const Journal& journal, const Append& edit) {
    const JournalStatus status = journal.status();
    const auto judged = judge(edit, {status.head, status.oldest - 1, nullptr}, edit.bytes.size());
    const auto* refused = judged ? std::get_if<Refused>(&*judged) : nullptr;
    if (refused == nullptr) return std::nullopt;
    return refusal_of(*refused, status.head);
}

/// The journal's lineage is part of what pages are named by: another journal counts its revisions from 0
/// again.
std::string fingerprint_with(const std::string& base, const EditId& lineage) {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx",
                  static_cast<unsigned long long>(mix(stream(base) ^ std::hash<EditId>{}(lineage))));
    return digits;
}

/// The ground as it was compiled, with the document's targets.
void take_ground(Scene& scene, const Scene& ground, const LiveDocument& document) {
    auto texture = ground.ground ? ground.ground : ground.texture;
    scene.ground_animated = ground.sprite_images ? ground.ground_animated : ground.animated;
    if (document.message && document.edited) {
        if (const auto targets = targets_of(document.message->targets()))
            texture = with_targets(std::move(texture), *targets);
        scene.ground_animated = ground.clocked || moved_by_targets(*texture);
    }
    if (scene.sprite_images)
        scene.ground = std::move(texture);
    else
        scene.texture = std::move(texture);
    scene.clocked = ground.clocked;
    scene.parameters = ground.parameters;
    scene.block_list = ground.block_list;
    scene.editable_maps = ground.editable_maps;
    scene.steps_per_second = document.clock.steps_per_second;
    if (!scene.sprite_images) scene.slices = ground.slices;
}

}  // namespace

LiveScene::LiveScene(ScenePtr base, std::unique_ptr<Journal> journal)
    : id_{base->id},
      base_{std::move(base)},
      book_{base_->sprites},
      document_{std::make_shared<const LiveDocument>(LiveDocument::of(*base_, now_at()))},
      ground_{base_},
      compiled_{document_},
      page_revisions_{page_revision_bytes},
      owned_journal_{std::move(journal)},
      journal_{owned_journal_.get()},
      lineage_{journal_->status().lineage} {}

LiveScene::~LiveScene() { close(); }

void LiveScene::close() {
    {
        const std::lock_guard lock{mutex_};
        if (std::exchange(closing_, true)) return;
    }
    lane_.request_stop();
    if (lane_.joinable()) lane_.join();
    if (snapshots_.joinable()) snapshots_.join();
    owned_journal_.reset();
    // What had not reached the journal
    for (std::deque<Work>* works : {&waiting_, &unprepared_}) {
        for (Work& work : *works)
            work.handler(EditRefusal{EditRefusal::Why::unavailable, "the server is stopping", head_});
        works->clear();
    }
}

Result<std::unique_ptr<LiveScene>> LiveScene::open(ScenePtr base, std::unique_ptr<Journal> journal,
                                                   Progress& progress) {
    std::unique_ptr<LiveScene> live{new LiveScene{std::move(base), std::move(journal)}};
    if (auto recovered = live->recover(progress); !recovered) return recovered.error();
    return live;
}

/// What edits made of a document, on another scene file.
Result<LiveScene::Rebased> LiveScene::rebased(const ScenePtr& base, const LiveDocument& document) const {
    LiveDocument moved = LiveDocument::of(*base, now_at());
    moved.clock = document.clock;
    ScenePtr ground = base;
    if (document.edited) {
        if (auto restored = moved.restore(document.whole_message()); !restored) return restored.error();
        auto compiled = compile(moved);
        if (!compiled) return compiled.error();
        ground = std::move(*compiled);
    }
    return Rebased{std::make_shared<const LiveDocument>(std::move(moved)), std::move(ground)};
}

void LiveScene::rebase(ScenePtr base) {
    std::unique_lock lock{mutex_};
    auto before = document_;
    for (int attempt = 1;; ++attempt) {
        // A plan takes as long as a start, and nobody waits for it, unless edits of blocks come without a
        // pause
        const bool last = attempt == most_rebases;
        if (!last) lock.unlock();
        auto made = rebased(base, *before);
        if (!last) lock.lock();
        if (const auto now = document_; now != before) {
            before = now;
            continue;
        }
        if (!made) {
            spdlog::error(
                "scene {}: goes on as it was, since what edits made of it does not fit its new files: {}",
                id_, made.error().detail);
            return;
        }
        base_ = std::move(base);
        ground_ = std::move(made->ground);
        document_ = compiled_ = std::move(made->document);
        return publish();
    }
}

SceneClock::Time LiveScene::now_at() const {
    return std::chrono::time_point_cast<std::chrono::milliseconds>(std::chrono::system_clock::now());
}

SceneClock LiveScene::clock() const {
    const std::lock_guard lock{mutex_};
    return document_->clock;
}

void LiveScene::edit(proto::Edit edit, Handler handler) {
    const auto refuse = [&](EditRefusal::Why why, std::string detail, Revision head) {
        handler(EditRefusal{why, std::move(detail), head});
    };
    const auto id = edit_id_from(edit.id());
    if (!id) return refuse(EditRefusal::Why::wrong, "id: is no UUID; draw one for each edit", 0);
    if (*id == EditId{})
        return refuse(EditRefusal::Why::wrong,
                      "id: is the nil UUID, which nobody drew; draw one for each edit", 0);
    auto canonical = canonical_edit(edit);
    if (!canonical) return refuse(EditRefusal::Why::wrong, canonical.error().detail, 0);
    if (const auto moves = check_moves(edit, now()->extent); !moves)
        return refuse(EditRefusal::Why::wrong, moves.error().detail, 0);

    std::unique_lock lock{mutex_};
    if (closing_ || waiting_.size() + unprepared_.size() >= max_waiting) {
        const auto why = closing_ ? EditRefusal::Why::unavailable : EditRefusal::Why::overloaded;
        const Revision head = head_;
        lock.unlock();
        return refuse(why,
                      why == EditRefusal::Why::overloaded ? "too many edits wait" : "the server is stopping",
                      head);
    }
    Work work;
    work.append = {.id = *id, .bytes = std::move(*canonical), .known = edit.known_revision(), .expected = {}};
    if (edit.has_base_revision()) work.append.expected = edit.base_revision();
    work.edit = std::move(edit);
    work.handler = std::move(handler);
    if (changes_document(work.edit)) {
        unprepared_.push_back(std::move(work));
        if (!lane_.joinable()) lane_ = std::jthread{[this](std::stop_token stop) { run_lane(stop); }};
        lane_wakes_.notify_one();
        return;
    }
    waiting_.push_back(std::move(work));
    if (!commits_) commit(std::move(lock));
}

std::optional<JournalStatus> LiveScene::journal_status() const {
    const std::lock_guard lock{mutex_};
    if (closing_) return std::nullopt;
    return journal_->status();
}

std::shared_ptr<void> LiveScene::listen(Listener listener) {
    auto kept = std::make_shared<Listener>(std::move(listener));
    const std::lock_guard lock{mutex_};
    std::erase_if(listeners_, [](const auto& other) { return other.expired(); });
    listeners_.push_back(kept);
    return kept;
}

SpritePatterns LiveScene::patterns() const noexcept {
    if (!base_->sprite_images) return {};
    return {base_->sprite_images->count(), base_->sprite_images->side(), base_->sprite_images->animations()};
}

/// Takes what waits, and gives what is possible to the journal.
void LiveScene::commit(std::unique_lock<std::mutex> lock) {
    commits_ = true;
    const PositioningMap before_commit = book_.map();
    std::vector<Append> batch;
    while (!waiting_.empty() && batch.size() < most_in_commit) {
        if (waiting_.front().group) {
            if (!batch.empty() && batch.size() + most_in_group > most_in_commit) break;
            take_group(batch);
            continue;
        }
        Work work = std::move(waiting_.front());
        waiting_.pop_front();
        const Revision before = head_ + batch.size();
        if (work.is_in) {
            // Already applied, or about to be
        } else if (work.append.expected && *work.append.expected != before) {
            work.outcome = EditRefusal{EditRefusal::Why::conflict,
                                       "base_revision: is " + std::to_string(*work.append.expected) +
                                           ", but the scene is at " + std::to_string(before),
                                       before};
        } else if (auto applied = apply_edit(work.edit, patterns(), book_)) {
            work.applied = std::move(*applied);
            work.append.step = document_->clock.read(now_at()).step;
        } else {
            work.outcome = EditRefusal{EditRefusal::Why::wrong, applied.error().detail, before};
        }
        if (work.outcome) {
            impossible_.push_back(std::move(work));
        } else {
            batch.push_back(work.append);
            committing_.push_back(std::move(work));
        }
    }
    if (batch.empty()) return finish(std::move(lock));
    before_commit_ = before_commit;
    lock.unlock();
    journal_->append(std::move(batch),
                     [this](std::vector<AppendOutcome> outcomes) { settle(std::move(outcomes)); });
}

/// The journal has decided: book_ is brought to what is in.
void LiveScene::settle(std::vector<AppendOutcome> outcomes) {
    std::unique_lock lock{mutex_};
    before_commit_.reset();
    bool as_expected = true;
    Revision next = head_ + 1, target = 0;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        Work& work = committing_[i];
        if (const auto* accepted = std::get_if<Accepted>(&outcomes[i])) {
            proto::EditAnswer answer;
            answer.set_revision(accepted->revision);
            answer.set_again(accepted->again);
            work.outcome = std::move(answer);
            as_expected = as_expected && !accepted->again && accepted->revision == next++;
            // A retry, too, may be of an edit whose fate was not known here
            target = std::max(target, accepted->revision);
            continue;
        }
        as_expected = false;
        if (const auto* conflict = std::get_if<Conflict>(&outcomes[i]))
            work.outcome = EditRefusal{EditRefusal::Why::conflict,
                                       "base_revision: is not the scene's any more", conflict->head};
        else if (const auto* refused = std::get_if<Refused>(&outcomes[i]))
            work.outcome = refusal_of(*refused, head_);
        else
            work.outcome =
                EditRefusal{EditRefusal::Why::unknown,
                            "the disk failed; send the edit again to learn whether it is in", head_};
    }
    // The scene's files changed meanwhile: what was prepared is made anew, of them
    if (in_commit_ && in_commit_->before != document_) as_expected = false;
    if (!as_expected) {
        // What the journal tells is the truth: it may hold edits whose fate was not known before
        take_back();
        if (target > head_) return catch_up(std::move(lock), target);
        return finish(std::move(lock));
    }
    for (Work& work : committing_)
        changes_.push_back(
            {++head_, work.applied->dirty, std::make_shared<proto::Edit>(std::move(work.edit))});
    if (in_commit_) {
        document_ = in_commit_->after;
        if (in_commit_->ground) ground_ = in_commit_->ground;
        compiled_ = document_;
        end_group();
    }
    finish(std::move(lock));
}

/// Undoes what is being committed, the last first.
void LiveScene::take_back() {
    for (std::size_t i = committing_.size(); i-- > 0;)
        if (committing_[i].applied) {
            apply_edit(committing_[i].applied->inverse, patterns(), book_).value();
            committing_[i].applied.reset();
        }
    if (in_commit_) end_group();
}

void LiveScene::catch_up(std::unique_lock<std::mutex> lock, Revision target) {
    const Revision from = head_ + 1;
    lock.unlock();
    auto ticket =
        journal_->follow(from, [this, target](History history) { take_history(std::move(history), target); });
    lock.lock();
    follows_ = std::move(ticket);
}

void LiveScene::take_history(History history, Revision target) {
    std::unique_lock lock{mutex_};
    const auto* edits = std::get_if<std::vector<Edit>>(&history);
    if (edits == nullptr) {
        // Nothing is lost: the next commit finds the gap and asks again
        spdlog::error("scene {}: the journal does not tell its edits after revision {}", id_, head_);
        return finish(std::move(lock));
    }
    for (const Edit& edit : *edits)
        if (edit.revision == head_ + 1) apply(edit, Planning::now);
    return head_ < target ? catch_up(std::move(lock), target) : finish(std::move(lock));
}

/// What is being committed may yet be refused.
const PositioningMap& LiveScene::sprites_at_head() const noexcept {
    return before_commit_ ? *before_commit_ : book_.map();
}

/// now() is what the book and the document say.
void LiveScene::publish() {
    compile_document();
    const PositioningMap& sprites = sprites_at_head();
    for (const Change& change : changes_)
        for (const TexelBox& box : change.dirty) page_revisions_.mark(box, change.revision);
    auto scene = std::make_shared<Scene>(*base_);
    scene->revision = head_;
    scene->fingerprint = fingerprint_with(base_->fingerprint, lineage_);
    scene->page_revisions = page_revisions_;
    scene->sprites = sprites;
    scene->clock = document_->clock;
    scene->message = document_->message;
    take_ground(*scene, *ground_, *document_);
    scene->animated = scene->ground_animated || sprites.living() > 0;
    if (scene->sprite_images)
        scene->texture = make_sprite_texture(scene->ground, scene->sprite_images, sprites);
    now_.store(std::move(scene));
}

/// Shows what was committed, answers, and goes on with what came meanwhile.
void LiveScene::finish(std::unique_lock<std::mutex> lock) {
    std::vector<Change> changes;
    std::vector<std::shared_ptr<Listener>> listeners;
    if (!changes_.empty()) {
        publish();
        changes = std::exchange(changes_, {});
        count_planned(changes);
        for (const auto& listener : listeners_)
            if (auto kept = listener.lock()) listeners.push_back(std::move(kept));
        keep_snapshot();
    }
    std::vector<Work> done = std::exchange(committing_, {}), impossible = std::exchange(impossible_, {});
    lock.unlock();

    for (const auto& listener : listeners) (*listener)(changes);
    for (Work& work : done) {
        if (auto* answer = std::get_if<proto::EditAnswer>(&*work.outcome); answer && work.applied) {
            *answer->mutable_inverse() = std::move(work.applied->inverse);
            for (proto::Effect& effect : work.applied->effects) *answer->add_effects() = std::move(effect);
            for (const TexelBox& box : work.applied->dirty) {
                proto::DirtyBox& dirty = *answer->add_dirty();
                dirty.set_x0(box.x0);
                dirty.set_y0(box.y0);
                dirty.set_x1(box.x1);
                dirty.set_y1(box.y1);
            }
        }
        work.handler(std::move(*work.outcome));
    }
    ask_for_retries(std::move(impossible));

    lock.lock();
    if (waiting_.empty() || closing_)
        commits_ = false;
    else
        commit(std::move(lock));
}

/// What is not possible may be a retry of what is in: then the journal answers it.
void LiveScene::ask_for_retries(std::vector<Work> refused) {
    for (Work& work : refused) {
        const auto kept = std::make_shared<Work>(std::move(work));
        journal_->find(kept->append.id, [this, kept](Result<std::optional<Revision>> found) {
            if (!found || !*found) {
                if (auto too_old = beyond_horizon(*journal_, kept->append))
                    kept->outcome = std::move(*too_old);
                return kept->handler(std::move(*kept->outcome));
            }
            std::unique_lock lock{mutex_};
            kept->outcome.reset();
            kept->is_in = true;
            waiting_.push_back(std::move(*kept));
            if (!commits_) commit(std::move(lock));
        });
    }
}

}  // namespace tessera
