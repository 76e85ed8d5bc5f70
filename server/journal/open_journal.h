#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "server/journal/journal.h"
#include "server/progress/progress.h"

namespace tessera {

struct JournalOptions {
    std::string scene;  ///< Whose edits these are; a journal of another scene is refused.
    JournalLimits limits;
    JournalHorizon horizon;
    std::function<JournalTime()> clock;  ///< Empty: the system's.
    std::string vfs;  ///< SQLite's access to the disk; empty: the system's. Tests make it fail.
};

/// Opens or makes the journal in `folder`: `journal.db` with its log, and snapshots. Reads all of it first
/// and says how far it is; errors name the file and the fix (SqliteStore::open, SnapshotFolder::open).
Result<std::unique_ptr<Journal>> open_journal(const std::filesystem::path& folder, JournalOptions options,
                                              Progress& progress);

/// A journal that lasts as long as the process.
std::unique_ptr<Journal> memory_journal(JournalOptions options);

}  // namespace tessera
