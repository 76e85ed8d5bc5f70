// Edits of more than sprites: what they make of the scene is compiled before they go to the journal, on a
// thread of its own, so that edits of sprites wait for none of it. What cannot be compiled never gets there.
#include <new>
#include <utility>

#include <spdlog/spdlog.h>

#include "server/edits/live_scene.h"

namespace tessera {

void LiveScene::run_lane(std::stop_token stop) {
    std::unique_lock lock{mutex_};
    for (;;) {
        lane_wakes_.wait(lock, stop, [this] { return !unprepared_.empty() && !group_waits_; });
        if (stop.stop_requested()) return;
        std::vector<Work> works;
        while (!unprepared_.empty() && works.size() < most_in_next_) {
            works.push_back(std::move(unprepared_.front()));
            unprepared_.pop_front();
        }
        prepare(std::move(works), lock);
    }
}

/// Makes the document that follows from `works`, compiles it, and lets those that are possible wait for the
/// next commit. Gives the lock back and takes it again.
void LiveScene::prepare(std::vector<Work> works, std::unique_lock<std::mutex>& lock) {
    auto group = std::make_shared<Group>();
    group->before = document_;
    const auto compiled = compiled_;
    lock.unlock();

    LiveDocument document = *group->before;
    std::vector<Work> possible, impossible;
    for (Work& work : works) {
        EditInstant instant{now_at(), 0};
        instant.step = document.clock.read(instant.at).step;
        work.append.step = instant.step;
        if (auto made = apply_to_document(work.edit, instant, document, Planning::in_time)) {
            work.document = std::move(*made);
            work.group = group;
            possible.push_back(std::move(work));
        } else {
            work.outcome = EditRefusal{EditRefusal::Why::wrong, made.error().detail, 0};
            impossible.push_back(std::move(work));
        }
    }
    if (!possible.empty() && !document.same_ground(*compiled)) {
        auto ground = this->compile(document);
        if (ground) {
            most_in_next_ = max_in_group;
            group->ground = std::move(*ground);
        } else if (possible.size() > 1) {
            // Each by itself was found possible, and not all together: who asks for too much must not stand
            // in others' way
            lock.lock();
            for (std::size_t i = possible.size(); i-- > 0;) {
                possible[i].group.reset();
                possible[i].document.reset();
                unprepared_.push_front(std::move(possible[i]));
            }
            most_in_next_ = possible.size() / 2;
            lock.unlock();
            possible.clear();
        } else {
            most_in_next_ = max_in_group;
            for (Work& work : possible) {
                work.group.reset();
                work.document.reset();
                work.outcome = EditRefusal{EditRefusal::Why::wrong, ground.error().detail, 0};
                impossible.push_back(std::move(work));
            }
            possible.clear();
        }
    }
    group->after = std::make_shared<const LiveDocument>(std::move(document));
    for (Work& work : impossible) std::get<EditRefusal>(*work.outcome).head = now()->revision;
    ask_for_retries(std::move(impossible));

    lock.lock();
    if (possible.empty()) return;
    group_waits_ = true;
    for (Work& work : possible) waiting_.push_back(std::move(work));
    if (commits_) return;
    commit(std::move(lock));
    lock = std::unique_lock{mutex_};
}

/// Gives the group that waits in front to the journal, all of it; or back, if not all of it is possible any
/// more.
void LiveScene::take_group(std::vector<Append>& batch) {
    const std::shared_ptr<Group> group = waiting_.front().group;
    std::vector<Work> works;
    while (!waiting_.empty() && waiting_.front().group == group) {
        works.push_back(std::move(waiting_.front()));
        waiting_.pop_front();
    }
    bool whole = group->before == document_;
    for (std::size_t i = 0; i < works.size() && whole; ++i) {
        Work& work = works[i];
        const Revision before = head_ + batch.size() + i;
        if (work.append.expected && *work.append.expected != before) {
            work.outcome = EditRefusal{EditRefusal::Why::conflict,
                                       "base_revision: is " + std::to_string(*work.append.expected) +
                                           ", but the scene is at " + std::to_string(before),
                                       before};
        } else if (auto applied = apply_edit(work.edit, patterns(), book_)) {
            work.applied = joined(std::move(*applied), *work.document);
        } else {
            work.outcome = EditRefusal{EditRefusal::Why::wrong, applied.error().detail, before};
        }
        whole = !work.outcome;
    }
    if (whole) {
        in_commit_ = group;
        for (Work& work : works) {
            batch.push_back(work.append);
            committing_.push_back(std::move(work));
        }
        return;
    }
    for (std::size_t i = works.size(); i-- > 0;) {
        Work& work = works[i];
        if (work.applied) apply_edit(work.applied->inverse, patterns(), book_).value();
        work.applied.reset();
        work.document.reset();
        work.group.reset();
        if (work.outcome)
            impossible_.push_back(std::move(work));
        else
            unprepared_.push_front(std::move(work));
    }
    end_group();
}

/// The next group may be prepared.
void LiveScene::end_group() {
    in_commit_.reset();
    group_waits_ = false;
    lane_wakes_.notify_one();
}

Result<ScenePtr> LiveScene::compile(const LiveDocument& document) const {
    // Input never throws on purpose, but memory may run out
    try {
        auto ground = std::make_shared<Scene>();
        if (auto done = document.source->compile(*document.message, document.painted, *ground); !done)
            return done.error();
        return ScenePtr{std::move(ground)};
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::io_failure, "there is not enough memory for it"};
    }
}

/// Where the journal brought edits that were not compiled before: after a restart, or a failed commit.
void LiveScene::compile_document() {
    if (compiled_ == document_) return;
    if (!document_->same_ground(*compiled_)) {
        auto ground = compile(*document_);
        if (!ground) {
            spdlog::error("scene {}: what its edits made of it cannot be shown: {}", id_,
                          ground.error().detail);
            return;
        }
        ground_ = std::move(*ground);
    }
    compiled_ = document_;
}

}  // namespace tessera
