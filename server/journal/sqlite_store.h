#pragma once

#include <filesystem>

#include "server/journal/journal_store.h"
#include "server/journal/sqlite.h"
#include "server/progress/progress.h"

namespace tessera {

struct SqliteStoreOptions {
    std::filesystem::path file;
    std::string scene;  ///< Whose edits these are: another scene's journal is refused.
    std::string vfs;    ///< SQLite's access to the disk; empty: the system's. Tests make it fail.
};

/// Edits in an SQLite file: WAL, synchronous=FULL, and one connection, which holds the file alone. It reads,
/// writes and checkpoints, so SQLite's WAL-reset bug (3.7.0 to 3.51.2), which needs two, cannot happen.
class SqliteStore final : public JournalStore {
  public:
    /// Opens or makes the file, and reads all of it: whole, gapless, every edit's checksum right. Errors name
    /// the file and the fix: invalid_input for another program's, a newer version's, another scene's or a
    /// damaged file; io_failure for a folder that cannot be written, or if another process has
    /// the file open; cancelled.
    static Result<std::unique_ptr<SqliteStore>> open(SqliteStoreOptions options, Progress& progress);
    ~SqliteStore() override;

    Revision head() const noexcept override { return head_; }
    Revision forgotten() const noexcept override { return forgotten_; }
    std::uint64_t bytes() const noexcept override { return bytes_; }
    JournalTime newest() const noexcept override { return newest_; }
    EditId lineage() const noexcept override { return lineage_; }
    Done commit(std::span<const Edit> edits, Revision forget) override;
    Done recover() override;
    Result<std::optional<Edit>> find(const EditId& id) override;
    Result<JournalTime> accepted_at(Revision revision) override;
    Result<std::vector<Edit>> read(Revision from, std::size_t edits, std::size_t bytes) override;
    Done tidy(bool idle) override;

  private:
    explicit SqliteStore(SqliteStoreOptions options) : options_{std::move(options)} {}
    Result<void> connect();
    Result<void> lay_out();
    Result<void> check(Progress& progress);
    Result<void> read_standing();
    void disconnect();
    int write(std::span<const Edit> edits, Revision forget, std::uint64_t& freed);
    int checkpoint();
    Result<Edit> edit_of(const sqlite::Statement& row) const;
    Error failed(const std::string& what, int code) const;
    Failure failure(const std::string& what, int code) const;

    const SqliteStoreOptions options_;
    Revision head_ = 0, forgotten_ = 0;
    std::uint64_t bytes_ = 0;
    JournalTime newest_{};
    EditId lineage_;

    sqlite::Connection database_;
    sqlite::Statement begin_, commit_, rollback_, insert_, measure_, forget_, note_forgotten_, find_,
        accepted_, read_;
    int wal_pages_ = 0;  ///< Not checkpointed yet.
};

}  // namespace tessera
