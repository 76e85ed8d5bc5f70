#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "shared/result/result.h"
#include "shared/revisions/edit_id.h"
#include "shared/revisions/revision.h"

namespace tessera {

using JournalTime = std::chrono::sys_time<std::chrono::milliseconds>;

/// An edit that wants to be accepted.
struct Append {
    EditId id;
    std::string bytes;  ///< What the journal keeps and compares, and never reads: the canonical edit.
    /// The newest revision that the client knew when it drew the id; a retry says it again. It is what tells
    /// a late retry of an edit that the journal has forgotten from a new edit, whatever `expected` says.
    Revision known = 0;
    /// Accepted only while this is the head, for an edit that must not overlook another.
    std::optional<Revision> expected;
    std::int64_t step = 0;  ///< Which step the scene showed: kept beside the edit, never compared.
};

/// An accepted edit.
struct Edit {
    Revision revision = 0;
    EditId id;
    JournalTime accepted;  ///< By the journal's clock; never less than that of the edit before.
    std::string bytes;
    std::int64_t step = 0;  ///< Of the append.
    bool operator==(const Edit&) const = default;
};

/// The edit is in, on the disk, for good.
struct Accepted {
    Revision revision = 0;
    bool again = false;  ///< It was in already, with the same bytes: this was a retry.
    bool operator==(const Accepted&) const = default;
};

/// Not in: `expected` was not the head.
struct Conflict {
    Revision head = 0;
    bool operator==(const Conflict&) const = default;
};

/// In or not in: the disk failed at the commit, and could not be asked afterwards. Appending the same edit
/// again, or find(), tells once the disk is back.
struct Unknown {
    bool operator==(const Unknown&) const = default;
};

/// Not in, and why, as far as a client would act on it differently.
enum class RefusalReason {
    other_content,    ///< The id is that of an accepted edit with other bytes: a client's bug.
    too_large,        ///< The edit, or the batch.
    outside_horizon,  ///< `known` is older than what the journal remembers, or no revision of it: read the
                      ///< present state, and decide again with a new id.
    overloaded,       ///< Passing: too many edits wait.
    full,             ///< The disk, or the journal's share of it.
    unavailable,      ///< The disk fails, or the journal is closed.
};

struct Refused {
    RefusalReason why{};
    std::string detail;  ///< For people: what, and the fix.
    bool operator==(const Refused& other) const { return why == other.why; }
};

using AppendOutcome = std::variant<Accepted, Conflict, Unknown, Refused>;

/// There is no such stretch of history: forgotten, or of another journal. Start from the newest snapshot.
struct OutsideHorizon {
    Revision oldest = 0;  ///< That is remembered; head + 1 if none is.
    Revision head = 0;
};

/// Consecutive edits, at least one; or why there are none.
using History = std::variant<std::vector<Edit>, OutsideHorizon, Refused>;

/// The scene's state after `revision`, so that older edits need not be replayed.
struct Snapshot {
    Revision revision = 0;
    std::string bytes;
};

struct JournalStatus {
    Revision head = 0;
    Revision oldest = 1;        ///< The first edit that is remembered; head + 1 if none is.
    Revision snapshot = 0;      ///< Of the newest snapshot.
    std::uint64_t bytes = 0;    ///< Of the edits that are remembered.
    bool snapshot_due = false;  ///< A new one would let the journal forget enough to stay in its bounds.
    std::string trouble;        ///< Why edits are refused now; empty when all is well.
    EditId lineage;             ///< Tells apart journals that count from 0 again.
};

/// The book of record of one scene's edits: durable once accepted, each id once, in one order. An edit that
/// was accepted is there after a kill, a power cut or a failed disk operation; one that was refused is not.
///
/// All members may be called from any thread and never wait for the disk. A handler is called once, on a
/// thread of the journal or, where nothing has to be waited for, before the call returns; it must not block.
/// Whoever follows hears of an edit before the edit's own answer is given.
class Journal {
  public:
    template <class Answer>
    using Handler = std::function<void(Answer)>;
    /// A wait that ends when the last copy is destroyed; the handler may still be called if it is just being
    /// called.
    using Ticket = std::shared_ptr<void>;

    Journal() = default;
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;
    /// Commits what was appended, answers everybody, and closes.
    virtual ~Journal() = default;

    /// Decides about each edit of the batch in turn, and commits those that are accepted at once: after a
    /// crash all of them are there or none. One outcome for each, in the same order.
    virtual void append(std::vector<Append> batch, Handler<std::vector<AppendOutcome>> handler) = 0;

    /// Under which revision an edit is in, if it is in and remembered.
    virtual void find(EditId id, Handler<Result<std::optional<Revision>>> handler) = 0;

    /// The edits from revision `from` on, some at a time: at once if there are any, else when the next ones
    /// are accepted. To go on, ask again from behind the last one.
    [[nodiscard]] virtual Ticket follow(Revision from, Handler<History> handler) = 0;

    /// Keeps a snapshot of a revision that is newer than the newest snapshot's; older edits may be forgotten
    /// from then on.
    virtual void keep_snapshot(Snapshot snapshot, Handler<Result<void>> handler) = 0;

    /// The newest snapshot that is whole and not newer than `at_most`; none, if the state of that time is
    /// the scene as it was before its first edit, or is forgotten.
    virtual void newest_snapshot(Revision at_most, Handler<Result<std::optional<Snapshot>>> handler) = 0;

    virtual JournalStatus status() const = 0;

    void append(Append edit, Handler<AppendOutcome> handler) {
        std::vector<Append> batch;
        batch.push_back(std::move(edit));
        append(std::move(batch), [handler = std::move(handler)](std::vector<AppendOutcome> outcomes) {
            handler(std::move(outcomes.front()));
        });
    }
};

/// What the journal remembers: an edit is forgotten, oldest first, once it is beyond one of these and behind
/// a snapshot. Older history and older ids are then refused by name.
struct JournalHorizon {
    Revision revisions = 1'000'000;  ///< Behind the head. Few: late retries are refused. Many: a larger file.
    std::chrono::seconds age{30 * 24 * 3600};      ///< Since it was accepted.
    std::uint64_t bytes = std::uint64_t{1} << 30;  ///< Of all edits; beyond it, without a snapshot, full.
};

/// Bounds on work and memory.
struct JournalLimits {
    std::size_t edit_bytes = std::size_t{64} << 10;    ///< Of one edit.
    std::size_t batch_edits = 4096;                    ///< Of one append.
    std::size_t queued_edits = 16'384;                 ///< That wait; beyond it, overloaded.
    std::size_t queued_bytes = std::size_t{32} << 20;  ///< Of the edits that wait.
    std::size_t commit_edits = 1024;                   ///< Share one commit, whole batches apart.
    std::size_t history_edits = 1024;                  ///< Of one answer to follow().
    std::size_t history_bytes = std::size_t{1} << 20;  ///< Of one answer to follow(), one edit apart.
    std::size_t queued_questions = 4096;               ///< Finds and follows that wait to be looked at.
};

}  // namespace tessera
