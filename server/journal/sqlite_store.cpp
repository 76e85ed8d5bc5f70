#include "server/journal/sqlite_store.h"

#include <algorithm>
#include <cstring>

#include <sqlite3.h>
#include <xxhash.h>

namespace tessera {
namespace {

constexpr int application_id = 0x7473726a;  ///< "tsrj": the file is a journal of ours.
constexpr int schema_version = 2;
constexpr int first_version = 1;  ///< The oldest that is brought up to date.

constexpr const char* schema = R"sql(
    CREATE TABLE journal (
        only      INTEGER PRIMARY KEY CHECK (only = 1),
        lineage   BLOB NOT NULL,
        scene     TEXT NOT NULL,
        forgotten INTEGER NOT NULL   -- edits up to this revision are gone
    ) STRICT;
    CREATE TABLE edit (
        revision INTEGER PRIMARY KEY,
        id       BLOB NOT NULL UNIQUE,
        accepted INTEGER NOT NULL,   -- milliseconds since 1970
        bytes    BLOB NOT NULL,
        checksum INTEGER NOT NULL,   -- XXH3 of all else; see checksum_of()
        step     INTEGER NOT NULL DEFAULT 0  -- that the scene showed; since version 2
    ) STRICT;
)sql";

constexpr const char* to_version_2 = R"sql(
    BEGIN IMMEDIATE;
    ALTER TABLE edit ADD COLUMN step INTEGER NOT NULL DEFAULT 0;
    PRAGMA user_version=2;
    COMMIT;
)sql";

// A checkpoint costs two syncs: done where nobody waits, or before the log is long
constexpr int idle_checkpoint_pages = 1000, longest_wal_pages = 4000;
constexpr int vacuumed_pages = 1024;  ///< Given back to the disk at a time, where nobody waits.

constexpr std::string_view stage = "check the journal";

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

EditId id_of(std::string_view bytes) noexcept {
    EditId id;
    std::memcpy(id.bytes.data(), bytes.data(), std::min(bytes.size(), id.bytes.size()));
    return id;
}

JournalTime time_of(std::int64_t milliseconds) noexcept {
    return JournalTime{std::chrono::milliseconds{milliseconds}};
}

std::int64_t integer(Revision revision) noexcept { return static_cast<std::int64_t>(revision); }

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

Result<std::unique_ptr<SqliteStore>> SqliteStore::open(SqliteStoreOptions options, Progress& progress) {
    std::unique_ptr<SqliteStore> store{new SqliteStore{std::move(options)}};
    if (const auto connected = store->connect(); !connected) return connected.error();
    if (const auto whole = store->check(progress); !whole) return whole.error();
    // A kill may have left edits that no sync has reached: an answer "accepted again" must hold
    if (const int code = store->checkpoint(); code != SQLITE_OK && (code & 0xff) != SQLITE_FULL)
        return store->failed("cannot be synced", code);
    return store;
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

/// Opens the file alone, durable as we want it, and of our layout.
Result<void> SqliteStore::connect() {
    int code = database_.open(options_.file.string(), options_.vfs);
    if (code != SQLITE_OK) return failed("cannot be opened", code);
    if (sqlite3_db_readonly(database_.handle(), "main") == 1) return failed("", SQLITE_READONLY);
    sqlite3_db_config(database_.handle(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    sqlite3_db_config(database_.handle(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database_.handle(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);

    // Alone, before anything of the file is touched: the index of the log is then in memory
    code = database_.execute("PRAGMA locking_mode=EXCLUSIVE");
    const auto ask = [&](const char* sql) {
        return code == SQLITE_OK ? database_.ask(sql, code) : std::string{};
    };
    const std::string id = ask("PRAGMA application_id"), version = ask("PRAGMA user_version"),
                      tables = ask("SELECT count(*) FROM sqlite_schema");
    if (code != SQLITE_OK) return failed("cannot be read", code);
    const std::string file = options_.file.string();
    const bool empty = tables == "0" && id == "0" && version == "0";  // Also after a kill in the first moment
    if (!empty && id != std::to_string(application_id))
        return Error{ErrorCode::invalid_input,
                     file + ": is a database of another program: name another folder"};
    const bool older = version == std::to_string(first_version);
    if (!empty && !older && version != std::to_string(schema_version))
        return Error{ErrorCode::invalid_input,
                     file + ": is a journal of version " + version + ", and this program knows version " +
                         std::to_string(schema_version) + ": use the program that wrote it, or a newer one"};
    if (empty) {
        code = database_.execute("PRAGMA auto_vacuum=INCREMENTAL");
        if (code != SQLITE_OK) return failed("cannot be laid out", code);
    }

    const auto count_pages = [](void* store, sqlite3*, const char*, int log_pages) {
        static_cast<SqliteStore*>(store)->wal_pages_ = log_pages;
        return SQLITE_OK;
    };
    sqlite3_wal_hook(database_.handle(), count_pages, this);
    const std::string mode = ask("PRAGMA journal_mode=WAL");
    if (code == SQLITE_OK) code = database_.execute("PRAGMA synchronous=FULL");
    if (code == SQLITE_OK) code = database_.execute("BEGIN IMMEDIATE; ROLLBACK");
    const std::string synchronous = ask("PRAGMA synchronous");
    if (code != SQLITE_OK) return failed("cannot be opened for writing", code);
    if (mode != "wal" || synchronous != "2")
        return Error{ErrorCode::io_failure, file + ": the disk does not let it be durable (journal_mode " +
                                                mode + ", synchronous " + synchronous +
                                                "): choose another folder"};
    if (empty) {
        if (auto laid_out = lay_out(); !laid_out) return laid_out.error();
    } else if (older) {
        code = database_.execute(to_version_2);
        if (code != SQLITE_OK) return failed("cannot be brought up to date", code);
    }

    const std::pair<std::string_view, sqlite::Statement*> statements[] = {
        {"BEGIN IMMEDIATE", &begin_},
        {"COMMIT", &commit_},
        {"ROLLBACK", &rollback_},
        {"INSERT INTO edit VALUES (?1, ?2, ?3, ?4, ?5, ?6)", &insert_},
        {"SELECT count(*), sum(length(bytes)) FROM edit WHERE revision <= ?1", &measure_},
        {"DELETE FROM edit WHERE revision <= ?1", &forget_},
        {"UPDATE journal SET forgotten = ?1", &note_forgotten_},
        {"SELECT revision, id, accepted, bytes, checksum, step FROM edit WHERE id = ?1", &find_},
        {"SELECT accepted FROM edit WHERE revision = ?1", &accepted_},
        {"SELECT revision, id, accepted, bytes, checksum, step FROM edit WHERE revision >= ?1 ORDER BY "
         "revision",
         &read_},
    };
    for (const auto& [sql, statement] : statements) {
        code = database_.prepare(sql, *statement);
        if (code != SQLITE_OK) return failed("has not the tables it should have", code);
    }
    return read_standing();
}

Result<void> SqliteStore::lay_out() {
    const std::string numbers = "PRAGMA application_id=" + std::to_string(application_id) +
                                "; PRAGMA user_version=" + std::to_string(schema_version);
    int code = database_.execute("BEGIN IMMEDIATE");
    if (code == SQLITE_OK) code = database_.execute(schema);
    if (code == SQLITE_OK) code = database_.execute(numbers.c_str());
    sqlite::Statement insert;
    if (code == SQLITE_OK) code = database_.prepare("INSERT INTO journal VALUES (1, ?1, ?2, 0)", insert);
    const EditId lineage = random_edit_id();
    if (code == SQLITE_OK)
        code = insert.bind(1, lineage.bytes).bind(2, std::string_view{options_.scene}).run();
    if (code == SQLITE_OK) code = database_.execute("COMMIT");
    if (code != SQLITE_OK) return failed("cannot be laid out", code);
    return {};
}

Result<void> SqliteStore::read_standing() {
    sqlite::Statement about, last;
    int code = database_.prepare("SELECT lineage, scene, forgotten FROM journal", about);
    if (code == SQLITE_OK)
        code = database_.prepare("SELECT revision, accepted FROM edit ORDER BY revision DESC LIMIT 1", last);
    if (code != SQLITE_OK) return failed("has not the tables it should have", code);
    code = about.step();
    if (code == SQLITE_DONE) code = SQLITE_CORRUPT;
    if (code != SQLITE_ROW) return failed("cannot be read", code);
    lineage_ = id_of(about.bytes(0));
    if (about.bytes(1) != options_.scene)
        return Error{ErrorCode::invalid_input, options_.file.string() + ": is the journal of scene " +
                                                   std::string{about.bytes(1)} + ", not of " +
                                                   options_.scene + ": name another folder"};
    forgotten_ = static_cast<Revision>(about.number(2));
    code = last.step();
    if (code != SQLITE_ROW && code != SQLITE_DONE) return failed("cannot be read", code);
    head_ = code == SQLITE_ROW ? static_cast<Revision>(last.number(0)) : forgotten_;
    newest_ = code == SQLITE_ROW ? time_of(last.number(1)) : JournalTime{};
    return {};
}

/// SQLite's own check of pages and indices, then every edit. Counts the bytes on the way.
Result<void> SqliteStore::check(Progress& progress) {
    const std::stop_token stop = progress.stop();
    progress.advance(stage, 0);
    // Half of the time for the pages, of which nothing is known but that there are so many
    struct Watch {
        Progress& progress;
        const std::stop_token& stop;
        double operations, expected;
    } watch{progress, stop, 0, 30.0 * double(head_ - forgotten_) + 1};
    constexpr int period = 50'000;
    const auto look = [](void* argument) {
        Watch& now = *static_cast<Watch*>(argument);
        now.operations += period;
        now.progress.advance(stage, 0.5 * std::min(1.0, now.operations / now.expected));
        return now.stop.stop_requested() ? 1 : 0;
    };
    sqlite3_progress_handler(database_.handle(), period, look, &watch);
    int code = SQLITE_OK;
    const std::string found = database_.ask("PRAGMA integrity_check(1)", code);
    sqlite3_progress_handler(database_.handle(), 0, nullptr, nullptr);
    if (code != SQLITE_OK) return failed("cannot be read", code);
    const auto damaged = [&](const std::string& how) {
        return Error{ErrorCode::invalid_input,
                     options_.file.string() + ": is damaged (" + how + "): put back a copy, or move it away"};
    };
    if (found != "ok") return damaged(found);

    Revision next = forgotten_ + 1;
    std::int64_t before = 0;
    bytes_ = 0;
    read_.bind(1, std::int64_t{0});
    while ((code = read_.step()) == SQLITE_ROW) {
        if (read_.number(0) != integer(next)) {
            read_.reset();
            return damaged("edit " + std::to_string(next) + " is missing");
        }
        const Result<Edit> edit = edit_of(read_);
        const std::int64_t accepted = read_.number(2);
        if (!edit || accepted < before) {
            read_.reset();
            if (!edit) return edit.error();
            return damaged("edit " + std::to_string(next) + " is older than the one before");
        }
        before = accepted;
        bytes_ += stored_bytes(*edit);
        if (next % 4096 == 0) {
            progress.advance(stage, 0.5 + 0.5 * double(next - forgotten_) / double(head_ - forgotten_));
            if (stop.stop_requested()) {
                read_.reset();
                return failed("", SQLITE_INTERRUPT);
            }
        }
        ++next;
    }
    read_.reset();
    if (code != SQLITE_DONE) return failed("cannot be read", code);
    progress.advance(stage, 1);
    return {};
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
