#include "server/journal/embedded_journal.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "server/journal/judge.h"

namespace tessera {
namespace {

using namespace std::chrono_literals;

constexpr auto idle_period = 1s;           ///< How long age goes unnoticed where nothing happens.
constexpr auto retry_period = 100ms;       ///< Between attempts on a disk that refused.
constexpr Revision replay_edits = 65'536;  ///< More behind the newest snapshot make one due.
constexpr std::size_t questions_at_once = 64;
constexpr std::size_t idle_forgets = 1024;  ///< Edits forgotten in one commit where nobody waits.

Refused closed() { return {RefusalReason::unavailable, "the journal is closed"}; }

Refused refusal_of(const JournalStore::Failure& failure) {
    return {failure.full ? RefusalReason::full : RefusalReason::unavailable, failure.detail};
}

std::size_t bytes_of(const std::vector<Append>& edits) noexcept {
    std::size_t bytes = 0;
    for (const Append& edit : edits) bytes += edit.bytes.size() + sizeof edit;
    return bytes;
}

}  // namespace

EmbeddedJournal::EmbeddedJournal(std::unique_ptr<JournalStore> edits,
                                 std::unique_ptr<SnapshotStore> snapshots, JournalLimits limits,
                                 JournalHorizon horizon, JournalClock clock)
    : limits_{limits},
      horizon_{horizon},
      clock_{std::move(clock)},
      snapshot_revisions_{snapshots->revisions()},
      edits_{std::move(edits)},
      keeper_{std::move(snapshots),
              [this](const std::vector<Revision>& revisions) { note_snapshots(revisions); }} {
    // What lies behind the newest snapshot is not measured anew: its share of all that is there
    due_counted_from_ = snapshot_revisions_.empty() ? 0 : snapshot_revisions_.back();
    const Revision there = edits_->head() - edits_->forgotten();
    const Revision behind = edits_->head() - std::min(due_counted_from_, edits_->head());
    if (there > 0)
        bytes_since_snapshot_ =
            static_cast<std::uint64_t>(double(edits_->bytes()) * double(behind) / double(there));
    publish();
    committer_ = std::jthread{[this] { run(); }};
}

EmbeddedJournal::~EmbeddedJournal() {
    {
        const std::lock_guard lock{mutex_};
        closing_ = true;
    }
    work_arrived_.notify_all();
    keeper_.close();
    committer_.join();
}

void EmbeddedJournal::append(std::vector<Append> batch, Handler<std::vector<AppendOutcome>> handler) {
    const std::size_t count = batch.size(), bytes = bytes_of(batch);
    std::optional<Refused> refused;
    if (count > limits_.batch_edits) {
        refused =
            Refused{RefusalReason::too_large, "the batch has " + std::to_string(count) +
                                                  " edits, more than " + std::to_string(limits_.batch_edits)};
    } else if (count != 0) {
        const std::lock_guard lock{mutex_};
        if (closing_) {
            refused = closed();
        } else if (queued_edits_ + count > limits_.queued_edits ||
                   (queued_edits_ != 0 && queued_bytes_ + bytes > limits_.queued_bytes)) {
            refused =
                Refused{RefusalReason::overloaded, std::to_string(queued_edits_) + " edits wait already"};
        } else {
            queued_edits_ += count;
            queued_bytes_ += bytes;
            batches_.push_back({std::move(batch), std::move(handler), {}, {}});
        }
    } else {
        return handler({});
    }
    if (refused) return handler(std::vector<AppendOutcome>(count, *refused));
    work_arrived_.notify_one();
}

void EmbeddedJournal::find(EditId id, Handler<Result<std::optional<Revision>>> handler) {
    {
        const std::lock_guard lock{mutex_};
        if (!closing_ && questions_.size() < limits_.queued_questions) {
            questions_.emplace_back(Find{id, std::move(handler)});
            work_arrived_.notify_one();
            return;
        }
    }
    handler(Error{ErrorCode::overloaded, "too many questions wait for the journal, or it is closed"});
}

Journal::Ticket EmbeddedJournal::follow(Revision from, Handler<History> handler) {
    auto ticket = std::make_shared<Follow>(Follow{from, std::move(handler)});
    Refused refused = closed();
    {
        const std::lock_guard lock{mutex_};
        if (!closing_ && questions_.size() < limits_.queued_questions) {
            questions_.emplace_back(std::weak_ptr<Follow>{ticket});
            work_arrived_.notify_one();
            return ticket;
        }
        if (!closing_) refused = {RefusalReason::overloaded, "too many questions wait for the journal"};
    }
    ticket->handler(refused);
    return ticket;
}

JournalStatus EmbeddedJournal::status() const {
    const std::lock_guard lock{mutex_};
    return status_;
}

void EmbeddedJournal::run() {
    for (;;) {
        Work work = take();
        if (work.empty() && work.closing) break;
        if (!work.batches.empty()) commit(work.batches);
        for (Question& question : work.questions) answer(question);
        if (work.empty()) forget_when_idle();
        publish();
        if (!broken_) note(edits_->tidy(work.empty()));
    }
    serve_waiting(true);
    edits_.reset();
}

EmbeddedJournal::Work EmbeddedJournal::take() {
    Work work;
    std::unique_lock lock{mutex_};
    work_arrived_.wait_for(lock, backlog_ ? 0s : idle_period, [this] {
        return !batches_.empty() || !questions_.empty() || closing_ || snapshots_ != snapshot_revisions_;
    });
    for (std::size_t edits = 0; !batches_.empty();) {
        const std::size_t count = batches_.front().edits.size();
        if (edits != 0 && edits + count > limits_.commit_edits) break;
        edits += count;
        queued_edits_ -= count;
        queued_bytes_ -= bytes_of(batches_.front().edits);
        work.batches.push_back(std::move(batches_.front()));
        batches_.pop_front();
    }
    while (!questions_.empty() && work.questions.size() < questions_at_once) {
        work.questions.push_back(std::move(questions_.front()));
        questions_.pop_front();
    }
    work.closing = closing_;
    snapshots_ = snapshot_revisions_;
    if (!snapshots_.empty() && snapshots_.back() != due_counted_from_) {
        due_counted_from_ = snapshots_.back();
        bytes_since_snapshot_ = 0;
    }
    return work;
}

void EmbeddedJournal::commit(std::vector<Batch>& batches) {
    if (!usable()) {
        for (Batch& batch : batches) batch.outcomes.assign(batch.edits.size(), refusal_of(*trouble_));
    } else {
        std::vector<Edit> fresh;
        std::unordered_map<EditId, std::size_t> fresh_ids;
        for (Batch& batch : batches) decide(batch, fresh, fresh_ids);
        if (!fresh.empty()) {
            const Revision forget = forget_target(fresh.size(), fresh.back().revision);
            if (const auto failure = edits_->commit(fresh, forget)) {
                settle(batches, fresh, *failure);
            } else {
                trouble_.reset();
            }
            if (!broken_ && edits_->head() >= fresh.back().revision) {
                for (const Edit& edit : fresh) bytes_since_snapshot_ += stored_bytes(edit);
                recent_ = std::move(fresh);
                serve_waiting(false);
            }
        }
    }
    publish();
    for (Batch& batch : batches) batch.handler(std::move(batch.outcomes));
}

/// Outcomes of one batch as if the commit had succeeded; what it adds goes to the end of `fresh`.
void EmbeddedJournal::decide(Batch& batch, std::vector<Edit>& fresh,
                             std::unordered_map<EditId, std::size_t>& fresh_ids) {
    const Revision head_before = edits_->head();
    const JournalTime now = std::max(clock_(), edits_->newest());
    std::uint64_t bytes = edits_->bytes();
    for (const Edit& edit : fresh) bytes += stored_bytes(edit);
    batch.outcomes.reserve(batch.edits.size());
    batch.of_this_commit.assign(batch.edits.size(), false);
    for (std::size_t i = 0; i < batch.edits.size(); ++i) {
        Append& append = batch.edits[i];
        // The accepted edit of this id: of this commit, or from before
        std::optional<Edit> stored;
        const Edit* same_id = nullptr;
        if (const auto found = fresh_ids.find(append.id); found != fresh_ids.end()) {
            same_id = &fresh[found->second];
        } else {
            Result<std::optional<Edit>> from_store = edits_->find(append.id);
            if (!from_store) {
                batch.outcomes.emplace_back(Refused{RefusalReason::unavailable, from_store.error().detail});
                continue;
            }
            stored = std::move(*from_store);
            if (stored) same_id = &*stored;
        }

        const Standing standing{head_before + fresh.size(), edits_->forgotten(), same_id};
        auto outcome = judge(append, standing, limits_.edit_bytes);
        Edit edit{standing.head + 1, append.id, now, {}, append.step};
        if (!outcome) {
            if (bytes + append.bytes.size() > horizon_.bytes) {
                outcome =
                    Refused{RefusalReason::full, "the journal holds " + std::to_string(bytes) + " of " +
                                                     std::to_string(horizon_.bytes) +
                                                     " bytes: it has room again after the next snapshot"};
            } else if (trouble_ && std::chrono::steady_clock::now() < retry_at_) {
                outcome = refusal_of(*trouble_);
            }
        }
        if (outcome) {
            // What stems from edits of this commit falls with them
            const Refused* const refused = std::get_if<Refused>(&*outcome);
            batch.of_this_commit[i] = !fresh.empty() && !stored &&
                                      !(refused != nullptr && refused->why == RefusalReason::too_large);
            batch.outcomes.push_back(std::move(*outcome));
            continue;
        }
        edit.bytes = std::move(append.bytes);
        bytes += stored_bytes(edit);
        fresh_ids.emplace(edit.id, fresh.size());
        batch.of_this_commit[i] = true;
        batch.outcomes.emplace_back(Accepted{edit.revision, false});
        fresh.push_back(std::move(edit));
    }
}

/// A commit failed: it may have happened. What is there after reading back decides.
void EmbeddedJournal::settle(std::vector<Batch>& batches, const std::vector<Edit>& fresh,
                             const JournalStore::Failure& failure) {
    trouble_ = failure;
    retry_at_ = std::chrono::steady_clock::now() + retry_period;
    AppendOutcome instead = refusal_of(failure);
    if (const auto again = edits_->recover()) {
        broken_ = true;
        trouble_ = again;
        instead = Unknown{};
    } else if (edits_->head() >= fresh.back().revision) {
        trouble_.reset();
        return;  // It did happen, and is durable now
    }
    for (Batch& batch : batches) {
        for (std::size_t i = 0; i < batch.outcomes.size(); ++i) {
            if (batch.of_this_commit[i]) batch.outcomes[i] = instead;
        }
    }
}

/// Whether the store can be asked; a broken one is tried again now and then.
bool EmbeddedJournal::usable() {
    if (!broken_) return true;
    const auto now = std::chrono::steady_clock::now();
    if (now < retry_at_) return false;
    if (auto failure = edits_->recover()) {
        trouble_ = std::move(failure);
        retry_at_ = std::chrono::steady_clock::now() + retry_period;
        return false;
    }
    broken_ = false;
    trouble_.reset();
    recent_.clear();
    serve_waiting(false);
    return true;
}

void EmbeddedJournal::answer(Question& question) {
    if (Find* const find = std::get_if<Find>(&question)) {
        if (!usable()) return find->handler(Error{ErrorCode::io_failure, trouble_->detail});
        const auto found = edits_->find(find->id);
        if (!found) return find->handler(found.error());
        return find->handler(*found ? std::optional{(*found)->revision} : std::nullopt);
    }
    const auto follow = std::get<std::weak_ptr<Follow>>(question).lock();
    if (!follow || serve(*follow)) return;
    // Tickets that were given up leave no trace for long
    if (waiting_.size() == waiting_.capacity())
        std::erase_if(waiting_, [](const std::weak_ptr<Follow>& other) { return other.expired(); });
    waiting_.push_back(follow);
}

/// Whether there was an answer.
bool EmbeddedJournal::serve(Follow& follow) {
    if (!usable()) {
        follow.handler(refusal_of(*trouble_));
        return true;
    }
    const Revision head = edits_->head(), forgotten = edits_->forgotten();
    if (follow.from == head + 1) return false;
    if (follow.from <= forgotten || follow.from > head) {
        follow.handler(OutsideHorizon{forgotten + 1, head});
        return true;
    }
    if (!recent_.empty() && recent_.front().revision == follow.from &&
        recent_.size() <= limits_.history_edits) {
        std::size_t bytes = 0;
        for (const Edit& edit : recent_) bytes += edit.bytes.size();
        if (bytes <= limits_.history_bytes) {
            follow.handler(recent_);
            return true;
        }
    }
    auto edits = edits_->read(follow.from, limits_.history_edits, limits_.history_bytes);
    if (edits)
        follow.handler(std::move(*edits));
    else
        follow.handler(Refused{RefusalReason::unavailable, edits.error().detail});
    return true;
}

void EmbeddedJournal::serve_waiting(bool closing) {
    std::vector<std::weak_ptr<Follow>> still;
    for (std::weak_ptr<Follow>& waiting : std::exchange(waiting_, {})) {
        const auto follow = waiting.lock();
        if (!follow) continue;
        if (closing)
            follow->handler(closed());
        else if (!serve(*follow))
            still.push_back(std::move(waiting));
    }
    waiting_ = std::move(still);
}

void EmbeddedJournal::forget_when_idle() {
    backlog_ = false;
    if (!usable()) return;
    const Revision target = forget_target(idle_forgets / 2, edits_->head());
    if (target == edits_->forgotten()) return;
    note(edits_->commit({}, target));
}

/// Of work that nobody waits for: what failed is read back.
void EmbeddedJournal::note(JournalStore::Done done) {
    if (!done) return;
    retry_at_ = std::chrono::steady_clock::now() + retry_period;
    trouble_ = std::move(done);
    if (auto again = edits_->recover()) {
        broken_ = true;
        trouble_ = std::move(again);
    }
}

/// Up to which revision a commit of so many edits, after which `head` is the newest, forgets. Bounded work
/// for each commit, and twice as much as comes in.
Revision EmbeddedJournal::forget_target(std::size_t edits, Revision head) {
    const Revision forgotten = edits_->forgotten();
    // Behind the last snapshot but one, in case the last is damaged; if there is no more room, behind the
    // last
    const Revision newest = snapshots_.empty() ? 0 : snapshots_.back();
    const Revision before_it = snapshots_.size() < 2 ? 0 : snapshots_[snapshots_.size() - 2];
    const Revision last = std::min(forgotten + 2 * edits + 64, edits_->head());
    Revision target = forgotten;

    const Revision end = std::min(before_it, last);
    if (head > horizon_.revisions) target = std::max(target, std::min(end, head - horizon_.revisions));
    const JournalTime cutoff = clock_() - horizon_.age;
    const auto too_old = [&](Revision revision) {
        const auto accepted = edits_->accepted_at(revision);
        return accepted && *accepted <= cutoff;
    };
    if (target < end && too_old(target + 1)) {
        for (Revision step = std::bit_ceil(end - target); step != 0; step /= 2) {
            if (target + step <= end && too_old(target + step)) target += step;
        }
    }
    if (edits_->bytes() > horizon_.bytes / 4 * 3) target = std::max(target, std::min(newest, last));
    backlog_ = target == last && target != head;
    return target;
}

/// Whether an edit behind the newest snapshot is beyond the horizon of time: without another snapshot it is
/// never forgotten, however old it gets.
bool EmbeddedJournal::waits_too_long_for_snapshot() {
    const Revision first = std::max(due_counted_from_, edits_->forgotten()) + 1;
    if (first > edits_->head()) return false;
    if (first != first_behind_snapshot_) {
        const auto accepted = edits_->accepted_at(first);
        if (!accepted) return false;
        first_behind_snapshot_ = first;
        accepted_behind_snapshot_ = *accepted;
    }
    return accepted_behind_snapshot_ <= clock_() - horizon_.age;
}

void EmbeddedJournal::publish() {
    if (broken_) {
        const std::lock_guard lock{mutex_};
        status_.trouble = trouble_->detail;
        return;
    }
    JournalStatus now;
    now.head = edits_->head();
    now.oldest = edits_->forgotten() + 1;
    now.bytes = edits_->bytes();
    now.lineage = edits_->lineage();
    if (trouble_) now.trouble = trouble_->detail;
    const bool is_old = waits_too_long_for_snapshot();
    const std::lock_guard lock{mutex_};
    now.snapshot = snapshot_revisions_.empty() ? 0 : snapshot_revisions_.back();
    now.snapshot_due =
        now.head > now.snapshot &&
        (now.head - now.snapshot >= std::min(replay_edits, horizon_.revisions / 4 + 1) || is_old ||
         bytes_since_snapshot_ > horizon_.bytes / 4 || now.bytes > horizon_.bytes / 8 * 7);
    status_ = std::move(now);
}

void EmbeddedJournal::keep_snapshot(Snapshot snapshot, Handler<Result<void>> handler) {
    keeper_.keep(std::move(snapshot), status().head, std::move(handler));
}

void EmbeddedJournal::newest_snapshot(Revision at_most, Handler<Result<std::optional<Snapshot>>> handler) {
    keeper_.newest(at_most, std::move(handler));
}

void EmbeddedJournal::note_snapshots(const std::vector<Revision>& revisions) {
    {
        const std::lock_guard lock{mutex_};
        snapshot_revisions_ = revisions;
        if (!revisions.empty()) status_.snapshot = revisions.back();
    }
    work_arrived_.notify_one();
}

}  // namespace tessera
