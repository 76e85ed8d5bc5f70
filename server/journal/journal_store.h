#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/journal/journal.h"

namespace tessera {

/// Where an embedded journal's edits lie: used by one thread, waits for the disk.
class JournalStore {
  public:
    /// How a failed commit failed.
    struct Failure {
        bool full = false;  ///< There was no room; else the disk or the file is broken.
        std::string detail;
    };
    using Done = std::optional<Failure>;  ///< Nothing when it went well.

    JournalStore() = default;
    JournalStore(const JournalStore&) = delete;
    JournalStore& operator=(const JournalStore&) = delete;
    virtual ~JournalStore() = default;  ///< Closes cleanly.

    virtual Revision head() const noexcept = 0;
    virtual Revision forgotten() const noexcept = 0;   ///< Edits up to this one are gone.
    virtual std::uint64_t bytes() const noexcept = 0;  ///< Of the edits that are there: stored_bytes() each.
    virtual JournalTime newest() const noexcept = 0;   ///< When the newest was accepted.
    virtual EditId lineage() const noexcept = 0;

    /// Adds `edits`, whose revisions go on from the head, and forgets those up to `forget`, all or nothing,
    /// durably. After a failure neither head() nor anything else is certain until recover() has succeeded.
    virtual Done commit(std::span<const Edit> edits, Revision forget) = 0;

    /// Reads back what is there after a failed commit, and makes that durable.
    virtual Done recover() = 0;

    virtual Result<std::optional<Edit>> find(const EditId& id) = 0;
    /// When `revision`, which is there, was accepted.
    virtual Result<JournalTime> accepted_at(Revision revision) = 0;
    /// Edits from `from`, which is there, on; at least one, then as long as both limits allow.
    virtual Result<std::vector<Edit>> read(Revision from, std::size_t edits, std::size_t bytes) = 0;

    /// Housekeeping after a commit; `idle` when nobody waits. A failure is as grave as that of a commit.
    virtual Done tidy(bool idle) = 0;
};

/// What an edit counts for in the journal's size: its bytes and a flat rate for what is kept beside them.
constexpr std::uint64_t stored_bytes(const Edit& edit) noexcept { return edit.bytes.size() + 128; }

/// Where snapshots lie: the newest two. Used by one thread, waits for the disk.
class SnapshotStore {
  public:
    SnapshotStore() = default;
    SnapshotStore(const SnapshotStore&) = delete;
    SnapshotStore& operator=(const SnapshotStore&) = delete;
    virtual ~SnapshotStore() = default;

    /// Revisions of the snapshots that are there, oldest first.
    virtual std::vector<Revision> revisions() const = 0;
    /// Durable when it returns; older ones than the newest two are then gone.
    virtual Result<void> keep(const Snapshot& snapshot) = 0;
    /// The newest that is whole and not newer than `at_most`.
    virtual Result<std::optional<Snapshot>> newest(Revision at_most) = 0;
};

}  // namespace tessera
