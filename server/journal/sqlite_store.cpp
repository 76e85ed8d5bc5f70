#include "server/journal/sqlite_store.h"

#include <algorithm>
#include <cstring>

#include <sqlite3.h>
#include <xxhash.h>

#include "server/journal/sqlite_values.h"

namespace tessera {
namespace {

using sqlite::id_of;
using sqlite::integer;
using sqlite::time_of;

// A checkpoint costs two syncs: done where nobody waits, or before the log is long
constexpr int idle_checkpoint_pages = 1000, longest_wal_pages = 4000;
constexpr int vacuumed_pages = 1024;  ///< Given back to the disk at a time, where nobody waits.

std::int64_t checksum_of(Revision revision, std::string_view id, std::int64_t accepted,
                         std::string_view bytes, std::int64_t step) {
    std::uint64_t names[5] = {revision, static_cast<std::uint64_t>(accepted), 0, 0,
                              static_cast<std::uint64_t>(step)};
    std::memcpy(names + 2, id.data(), std::min(id.size(), sizeof(EditId)));
    // Edits of version 1 have no step, and keep their checksums
    const std::size_t named = step == 0 ? 4 * sizeof names[0] : sizeof names;
    return static_cast<std::int64_t>(
        XXH3_64bits_withSeed(bytes.data(), bytes.size(), XXH3_64bits(names, named)));
}

std::string_view text_of(const EditId& id) noexcept {
    return {reinterpret_cast<const char*>(id.bytes.data()), id.bytes.size()};
}

}  // namespace

Error SqliteStore::failed(const std::string& what, int code) const {
    const std::string file = options_.file.string();
    switch (code & 0xff) {
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            return {ErrorCode::io_failure, file + ": another process has this journal open: stop it first"};
        case SQLITE_NOTADB:
            return {ErrorCode::invalid_input,
                    file + ": is not a journal: move it away, or name another folder"};
        case SQLITE_CORRUPT:
            return {ErrorCode::invalid_input,
                    file + ": is damaged (" + database_.message() + "): put back a copy, or move it away"};
        case SQLITE_READONLY:
            return {ErrorCode::io_failure,
                    file + ": cannot be written: make the file and its folder writable"};
        case SQLITE_CANTOPEN:
        case SQLITE_PERM:
            return {ErrorCode::io_failure,
                    file + ": cannot be opened: the folder must exist and be writable"};
        case SQLITE_FULL:
            return {ErrorCode::io_failure,
                    file + ": the disk is full: make room, edits are taken again then"};
        case SQLITE_INTERRUPT:
            return {ErrorCode::cancelled, file + ": the check was stopped"};
        default:
            return {ErrorCode::io_failure, file + ": " + what + ": " + database_.message() + " (" +
                                               sqlite3_errstr(code) + ", " + std::to_string(code) + ")"};
    }
}

JournalStore::Failure SqliteStore::failure(const std::string& what, int code) const {
    return {(code & 0xff) == SQLITE_FULL, failed(what, code).detail};
}

SqliteStore::~SqliteStore() {
    if (!database_.is_open()) return;
    checkpoint();
    disconnect();
}

void SqliteStore::disconnect() {
    for (sqlite::Statement* statement : {&begin_, &commit_, &rollback_, &insert_, &measure_, &forget_,
                                         &note_forgotten_, &find_, &accepted_, &read_})
        *statement = {};
    database_.close();
}

JournalStore::Done SqliteStore::commit(std::span<const Edit> edits, Revision forget) {
    std::uint64_t freed = 0;
    const int code = write(edits, forget, freed);
    if (code != SQLITE_OK) {
        Failure why = failure("cannot be written", code);
        if (sqlite3_get_autocommit(database_.handle()) == 0) rollback_.run();
        return why;
    }
    for (const Edit& edit : edits) bytes_ += stored_bytes(edit);
    bytes_ -= freed;
    if (!edits.empty()) {
        head_ = edits.back().revision;
        newest_ = edits.back().accepted;
    }
    forgotten_ = std::max(forgotten_, forget);
    return std::nullopt;
}

int SqliteStore::write(std::span<const Edit> edits, Revision forget, std::uint64_t& freed) {
    int code = begin_.run();
    for (std::size_t i = 0; i < edits.size() && code == SQLITE_OK; ++i) {
        const Edit& edit = edits[i];
        const std::int64_t accepted = edit.accepted.time_since_epoch().count();
        code = insert_.bind(1, integer(edit.revision))
                   .bind(2, edit.id.bytes)
                   .bind(3, accepted)
                   .bind_bytes(4, edit.bytes)
                   .bind(5, checksum_of(edit.revision, text_of(edit.id), accepted, edit.bytes, edit.step))
                   .bind(6, edit.step)
                   .run();
    }
    if (code == SQLITE_OK && forget > forgotten_) {
        code = measure_.bind(1, integer(forget)).step() == SQLITE_ROW ? SQLITE_OK : SQLITE_CORRUPT;
        freed = static_cast<std::uint64_t>(measure_.number(0) * 128 + measure_.number(1));
        measure_.reset();
        if (code == SQLITE_OK) code = forget_.bind(1, integer(forget)).run();
        if (code == SQLITE_OK) code = note_forgotten_.bind(1, integer(forget)).run();
    }
    if (code == SQLITE_OK) code = commit_.run();
    return code;
}

/// Nothing in memory is believed, nor that a sync which failed and then succeeds has written anything: the
/// file is opened anew, and what its log holds is copied into the file itself, which is synced.
JournalStore::Done SqliteStore::recover() {
    disconnect();
    const std::uint64_t bytes_before = bytes_;
    const Revision head_before = head_, forgotten_before = forgotten_;
    const EditId lineage = lineage_;
    if (const auto connected = connect(); !connected) {
        disconnect();
        return Failure{false, connected.error().detail};
    }
    if (lineage_ != lineage || head_ < head_before) {
        disconnect();
        return Failure{false, options_.file.string() + ": lost edits that were accepted: the disk is broken"};
    }
    if (head_ != head_before || forgotten_ != forgotten_before) {
        int code = SQLITE_OK;
        const std::string bytes = database_.ask("SELECT ifnull(sum(length(bytes) + 128), 0) FROM edit", code);
        if (code != SQLITE_OK) return failure("cannot be read", code);
        bytes_ = std::stoull(bytes);
    } else {
        bytes_ = bytes_before;
    }
    const int code = checkpoint();
    if (code == SQLITE_OK) return std::nullopt;
    // Where there is no room for the copy, it is certain all the same that what is not there never was
    if ((code & 0xff) == SQLITE_FULL && head_ == head_before) return std::nullopt;
    return failure("cannot be synced", code);
}

int SqliteStore::checkpoint() {
    int frames = 0, copied = 0;
    const int code =
        sqlite3_wal_checkpoint_v2(database_.handle(), "main", SQLITE_CHECKPOINT_TRUNCATE, &frames, &copied);
    if (code == SQLITE_OK) wal_pages_ = 0;
    return code;
}

Result<Edit> SqliteStore::edit_of(const sqlite::Statement& row) const {
    const auto revision = static_cast<Revision>(row.number(0));
    const std::string_view id = row.bytes(1), bytes = row.bytes(3);
    if (id.size() != sizeof(EditId) ||
        checksum_of(revision, id, row.number(2), bytes, row.number(5)) != row.number(4))
        return Error{ErrorCode::invalid_input, options_.file.string() + ": edit " + std::to_string(revision) +
                                                   " is damaged: put back a copy, or move it away"};
    return Edit{revision, id_of(id), time_of(row.number(2)), std::string{bytes}, row.number(5)};
}

Result<std::optional<Edit>> SqliteStore::find(const EditId& id) {
    const int code = find_.bind(1, id.bytes).step();
    Result<std::optional<Edit>> found = std::optional<Edit>{};
    if (code == SQLITE_ROW) {
        if (Result<Edit> edit = edit_of(find_))
            found = std::optional{std::move(*edit)};
        else
            found = edit.error();
    } else if (code != SQLITE_DONE) {
        found = failed("cannot be read", code);
    }
    find_.reset();
    return found;
}

Result<JournalTime> SqliteStore::accepted_at(Revision revision) {
    const int code = accepted_.bind(1, integer(revision)).step();
    Result<JournalTime> time = time_of(accepted_.number(0));
    if (code != SQLITE_ROW) time = failed("cannot be read", code == SQLITE_DONE ? SQLITE_CORRUPT : code);
    accepted_.reset();
    return time;
}

Result<std::vector<Edit>> SqliteStore::read(Revision from, std::size_t edits, std::size_t bytes) {
    std::vector<Edit> history;
    read_.bind(1, integer(from));
    int code = SQLITE_OK;
    for (std::size_t sum = 0; history.size() < edits && (code = read_.step()) == SQLITE_ROW;) {
        sum += read_.bytes(3).size();
        if (!history.empty() && sum > bytes) break;
        Result<Edit> edit = edit_of(read_);
        if (!edit) {
            read_.reset();
            return edit.error();
        }
        history.push_back(std::move(*edit));
    }
    read_.reset();
    if (code != SQLITE_ROW && code != SQLITE_DONE) return failed("cannot be read", code);
    if (history.empty()) return failed("cannot be read", SQLITE_CORRUPT);
    return history;
}

JournalStore::Done SqliteStore::tidy(bool idle) {
    // A checkpoint that fails has changed nothing that is believed: the log still holds all, and the next one
    // copies it again. It leaves the log's file as long as it is, so that commits need not make it grow
    if (wal_pages_ >= (idle ? idle_checkpoint_pages : longest_wal_pages)) {
        const int code = sqlite3_wal_checkpoint_v2(database_.handle(), "main", SQLITE_CHECKPOINT_PASSIVE,
                                                   nullptr, nullptr);
        if (code == SQLITE_OK) wal_pages_ = 0;
    }
    if (!idle) return std::nullopt;
    int code = SQLITE_OK;
    const auto ask = [&](const char* sql) {
        const std::string answer = code == SQLITE_OK ? database_.ask(sql, code) : std::string{};
        return answer.empty() ? 0 : std::stoll(answer);
    };
    const auto unused = ask("PRAGMA freelist_count"), all = ask("PRAGMA page_count");
    if (code == SQLITE_OK && unused > vacuumed_pages && unused > all / 4) {
        const std::string vacuum = "PRAGMA incremental_vacuum(" + std::to_string(vacuumed_pages) + ")";
        code = database_.execute(vacuum.c_str());
    }
    if (code != SQLITE_OK) return failure("cannot be made smaller", code);
    return std::nullopt;
}

}  // namespace tessera
