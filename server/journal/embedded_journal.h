#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <unordered_map>

#include "server/journal/journal_store.h"
#include "server/journal/snapshot_keeper.h"

namespace tessera {

using JournalClock = std::function<JournalTime()>;

/// A journal inside this process, over a store of edits and one of snapshots. One thread commits: it takes
/// all that waits, makes it one transaction, and answers everybody (group commit).
class EmbeddedJournal final : public Journal {
  public:
    EmbeddedJournal(std::unique_ptr<JournalStore> edits, std::unique_ptr<SnapshotStore> snapshots,
                    JournalLimits limits, JournalHorizon horizon, JournalClock clock);
    ~EmbeddedJournal() override;

    using Journal::append;
    void append(std::vector<Append> batch, Handler<std::vector<AppendOutcome>> handler) override;
    void find(EditId id, Handler<Result<std::optional<Revision>>> handler) override;
    Ticket follow(Revision from, Handler<History> handler) override;
    void keep_snapshot(Snapshot snapshot, Handler<Result<void>> handler) override;
    void newest_snapshot(Revision at_most, Handler<Result<std::optional<Snapshot>>> handler) override;
    JournalStatus status() const override;

  private:
    using SteadyTime = std::chrono::steady_clock::time_point;
    struct Batch {
        std::vector<Append> edits;
        Handler<std::vector<AppendOutcome>> handler;
        std::vector<AppendOutcome> outcomes;
        std::vector<bool> of_this_commit;  ///< The outcome holds only if this commit succeeds.
    };
    struct Find {
        EditId id;
        Handler<Result<std::optional<Revision>>> handler;
    };
    struct Follow {
        Revision from = 0;
        Handler<History> handler;
    };
    using Question = std::variant<Find, std::weak_ptr<Follow>>;
    struct Work {
        std::vector<Batch> batches;
        std::vector<Question> questions;
        bool closing = false;
        bool empty() const noexcept { return batches.empty() && questions.empty(); }
    };

    // The thread that commits
    void run();
    Work take();
    void commit(std::vector<Batch>& batches);
    void decide(Batch& batch, std::vector<Edit>& fresh, std::unordered_map<EditId, std::size_t>& fresh_ids);
    void settle(std::vector<Batch>& batches, const std::vector<Edit>& fresh,
                const JournalStore::Failure& failure);
    bool usable();
    void answer(Question& question);
    bool serve(Follow& follow);
    void serve_waiting(bool closing);
    void forget_when_idle();
    void note(JournalStore::Done done);
    Revision forget_target(std::size_t edits, Revision head);
    bool waits_too_long_for_snapshot();
    void publish();

    void note_snapshots(const std::vector<Revision>& revisions);

    const JournalLimits limits_;
    const JournalHorizon horizon_;
    const JournalClock clock_;

    mutable std::mutex mutex_;  ///< Guards what follows; never held while waiting for the disk or a handler.
    std::condition_variable work_arrived_;
    std::deque<Batch> batches_;
    std::deque<Question> questions_;
    std::size_t queued_edits_ = 0, queued_bytes_ = 0;
    std::vector<Revision> snapshot_revisions_;
    bool closing_ = false;
    JournalStatus status_;

    // Used by the thread that commits, and nobody else
    std::unique_ptr<JournalStore> edits_;
    std::vector<std::weak_ptr<Follow>> waiting_;
    std::vector<Edit> recent_;  ///< Of the last commit: what those who follow mostly ask for.
    std::vector<Revision> snapshots_;
    std::optional<JournalStore::Failure> trouble_;
    bool broken_ = false;   ///< The store has to recover() first.
    bool backlog_ = false;  ///< There is more to forget.
    SteadyTime retry_at_{};
    Revision due_counted_from_ = 0;  ///< bytes_since_snapshot_ counts from this snapshot on.
    std::uint64_t bytes_since_snapshot_ = 0;
    Revision first_behind_snapshot_ = 0;  ///< Whose time is the next one; 0: of none yet.
    JournalTime accepted_behind_snapshot_{};

    SnapshotKeeper keeper_;
    std::jthread committer_;  ///< Last: it uses everything above.
};

}  // namespace tessera
