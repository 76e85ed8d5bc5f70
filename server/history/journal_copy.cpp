#include "server/history/journal_copy.h"

#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "server/journal/open_journal.h"

namespace tessera {

namespace {

namespace fs = std::filesystem;

constexpr int attempts = 20;

/// What tells whether SQLite's log was begun anew, or the file written without one.
struct Mark {
    std::string log_header;  ///< The log's first 32 bytes, with the salts that every new beginning changes.
    fs::file_time_type written{};  ///< The database's, which matters only where there is no log.
    bool operator==(const Mark&) const = default;
};

Mark mark_of(const fs::path& folder) {
    Mark mark;
    std::ifstream log{folder / "journal.db-wal", std::ios::binary};
    mark.log_header.resize(32);
    log.read(mark.log_header.data(), 32);
    mark.log_header.resize(static_cast<std::size_t>(log.gcount()));
    std::error_code failure;
    if (mark.log_header.size() < 32) mark.written = fs::last_write_time(folder / "journal.db", failure);
    return mark;
}

/// Copies what is there; what has gone meanwhile is left out.
std::error_code copy_if_there(const fs::path& from, const fs::path& to) {
    std::error_code failure;
    fs::copy_file(from, to, fs::copy_options::overwrite_existing, failure);
    return failure == std::errc::no_such_file_or_directory ? std::error_code{} : failure;
}

/// The files, in the order that makes them fit each other: a snapshot is never newer than the edits, and the
/// log holds all that its writer may have been putting into the database while that was copied.
std::error_code copy_files(const fs::path& from, const fs::path& to) {
    std::error_code failure;
    std::vector<fs::path> snapshots;
    for (fs::directory_iterator entry{from, failure}, end; !failure && entry != end; entry.increment(failure))
        if (entry->path().filename().string().starts_with("snapshot-")) snapshots.push_back(entry->path());
    for (const fs::path& snapshot : snapshots)
        if (!failure) failure = copy_if_there(snapshot, to / snapshot.filename());
    for (const char* name : {"journal.db", "journal.db-wal"})
        if (!failure) failure = copy_if_there(from / name, to / name);
    return failure;
}

std::string with(std::string text, const std::string& what, const std::string& instead) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += instead.size())
        text.replace(at, what.size(), instead);
    return text;
}

/// Whether the state at every remembered revision can be made: a snapshot that was removed, with older edits,
/// while we copied is missed here.
bool is_whole(Journal& journal) {
    const JournalStatus status = journal.status();
    return status.snapshot + 1 >= status.oldest;
}

}  // namespace

Result<JournalCopy> JournalCopy::take(const fs::path& folder, const std::string& scene, Progress& progress) {
    std::error_code failure;
    if (!fs::is_regular_file(folder / "journal.db", failure))
        return Error{ErrorCode::io_failure,
                     folder.string() +
                         ": holds no journal of edits: the scene was never served, takes "
                         "none, or its edits are in the folder that --edits names"};
    std::string place = (fs::temp_directory_path(failure) / "tessera-journal-XXXXXX").string();
    if (failure || ::mkdtemp(place.data()) == nullptr)
        return Error{ErrorCode::io_failure, place + ": cannot be made; TMPDIR names another place"};
    auto copied = std::make_unique<RemovedAtEnd>(place);

    Error last{ErrorCode::io_failure, folder.string() + ": changes faster than it can be copied; ask again"};
    for (int attempt = 0; attempt < attempts; ++attempt) {
        if (progress.stop().stop_requested()) return Error{ErrorCode::cancelled, "stopped"};
        const fs::path here = copied->folder / std::to_string(attempt);
        const RemovedAtEnd failed{attempt == 0 ? "" : copied->folder / std::to_string(attempt - 1)};
        if (!fs::create_directory(here, failure)) break;
        const Mark before = mark_of(folder);
        if (failure = copy_files(folder, here); failure)
            return Error{ErrorCode::io_failure, folder.string() + ": cannot be copied to " + place + ": " +
                                                    failure.message() + "; TMPDIR names another place"};
        if (mark_of(folder) != before || mark_of(here).log_header != before.log_header) continue;

        JournalOptions options;
        options.scene = scene;
        auto journal = open_journal(here, options, progress);
        if (journal && is_whole(**journal)) return JournalCopy{std::move(copied), std::move(*journal)};
        if (journal) continue;
        last = {journal.error().code, with(journal.error().detail, here.string(), folder.string())};
        // A journal that is damaged stays so; what was torn by our copying does not
        if (last.code == ErrorCode::cancelled || attempt >= 2) break;
    }
    return last;
}

}  // namespace tessera
