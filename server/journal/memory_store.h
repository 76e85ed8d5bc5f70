#pragma once

#include <deque>
#include <unordered_map>

#include "server/journal/journal_store.h"

namespace tessera {

/// Edits in memory, for tests and for servers that may forget: durable as long as the process.
class MemoryStore final : public JournalStore {
  public:
    MemoryStore() : lineage_{random_edit_id()} {}

    Revision head() const noexcept override { return forgotten_ + edits_.size(); }
    Revision forgotten() const noexcept override { return forgotten_; }
    std::uint64_t bytes() const noexcept override { return bytes_; }
    JournalTime newest() const noexcept override { return newest_; }
    EditId lineage() const noexcept override { return lineage_; }
    Done commit(std::span<const Edit> edits, Revision forget) override;
    Done recover() override { return std::nullopt; }
    Result<std::optional<Edit>> find(const EditId& id) override;
    Result<JournalTime> accepted_at(Revision revision) override { return at(revision).accepted; }
    Result<std::vector<Edit>> read(Revision from, std::size_t edits, std::size_t bytes) override;
    Done tidy(bool) override { return std::nullopt; }

  private:
    const Edit& at(Revision revision) const {
        return edits_[static_cast<std::size_t>(revision - forgotten_ - 1)];
    }

    const EditId lineage_;
    Revision forgotten_ = 0;
    std::uint64_t bytes_ = 0;
    JournalTime newest_{};
    std::deque<Edit> edits_;  ///< From revision forgotten_ + 1 on.
    std::unordered_map<EditId, Revision> revisions_;
};

/// The newest two snapshots in memory.
class MemorySnapshots final : public SnapshotStore {
  public:
    std::vector<Revision> revisions() const override;
    Result<void> keep(const Snapshot& snapshot) override;
    Result<std::optional<Snapshot>> newest(Revision at_most) override;

  private:
    std::deque<Snapshot> snapshots_;
};

}  // namespace tessera
