#pragma once

#include <filesystem>

#include "server/journal/journal_store.h"

namespace tessera {

/// The newest two snapshots as files `snapshot-<revision>` of a folder. A file is written under another name,
/// synced, and renamed: what bears the name is whole, and its hash says so.
class SnapshotFolder final : public SnapshotStore {
  public:
    /// Finds the snapshots that are there, and removes what an interrupted keep() left. Those newer than
    /// `head`, of a journal that was set back, are refused as invalid_input.
    static Result<std::unique_ptr<SnapshotFolder>> open(std::filesystem::path folder, EditId lineage,
                                                        Revision head);

    std::vector<Revision> revisions() const override { return revisions_; }
    Result<void> keep(const Snapshot& snapshot) override;
    Result<std::optional<Snapshot>> newest(Revision at_most) override;

  private:
    SnapshotFolder(std::filesystem::path folder, EditId lineage)
        : folder_{std::move(folder)}, lineage_{lineage} {}
    std::filesystem::path file_of(Revision revision) const;
    Result<Snapshot> read(Revision revision) const;

    const std::filesystem::path folder_;
    const EditId lineage_;
    std::vector<Revision> revisions_;  ///< Oldest first.
};

}  // namespace tessera
