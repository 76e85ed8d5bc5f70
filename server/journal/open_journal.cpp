#include "server/journal/open_journal.h"

#include "server/files/whole_file.h"
#include "server/journal/embedded_journal.h"
#include "server/journal/memory_store.h"
#include "server/journal/snapshot_folder.h"
#include "server/journal/sqlite_store.h"

namespace tessera {
namespace {

JournalTime system_time() {
    return std::chrono::time_point_cast<std::chrono::milliseconds>(std::chrono::system_clock::now());
}

JournalClock clock_of(const JournalOptions& options) {
    return options.clock ? options.clock : JournalClock{system_time};
}

}  // namespace

Result<std::unique_ptr<Journal>> open_journal(const std::filesystem::path& folder, JournalOptions options,
                                              Progress& progress) {
    std::error_code error;
    const std::filesystem::path whole = std::filesystem::absolute(folder, error).lexically_normal();
    if (std::filesystem::create_directories(whole, error)) {
        const bool slash = !whole.has_filename();
        const auto parent = slash ? whole.parent_path().parent_path() : whole.parent_path();
        if (const auto synced = sync_folder(parent); !synced) return synced.error();
    }
    if (error) return Error{ErrorCode::io_failure, whole.string() + ": cannot be made: " + error.message()};

    auto edits = SqliteStore::open({whole / "journal.db", options.scene, options.vfs}, progress);
    if (!edits) return edits.error();
    auto snapshots = SnapshotFolder::open(whole, (*edits)->lineage(), (*edits)->head());
    if (!snapshots) return snapshots.error();
    return std::unique_ptr<Journal>{std::make_unique<EmbeddedJournal>(
        std::move(*edits), std::move(*snapshots), options.limits, options.horizon, clock_of(options))};
}

std::unique_ptr<Journal> memory_journal(JournalOptions options) {
    return std::make_unique<EmbeddedJournal>(std::make_unique<MemoryStore>(),
                                             std::make_unique<MemorySnapshots>(), options.limits,
                                             options.horizon, clock_of(options));
}

}  // namespace tessera
