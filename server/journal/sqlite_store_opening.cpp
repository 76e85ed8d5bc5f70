// A journal's file is opened: alone, durable, of our layout, and whole.
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include <sqlite3.h>

#include "server/journal/sqlite_store.h"
#include "server/journal/sqlite_values.h"

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

constexpr std::string_view stage = "checking the journal";

}  // namespace

Result<std::unique_ptr<SqliteStore>> SqliteStore::open(SqliteStoreOptions options, Progress& progress) {
    std::unique_ptr<SqliteStore> store{new SqliteStore{std::move(options)}};
    if (const auto connected = store->connect(); !connected) return connected.error();
    if (const auto whole = store->check(progress); !whole) return whole.error();
    // A kill may have left edits that no sync has reached: an answer "accepted again" must hold
    if (const int code = store->checkpoint(); code != SQLITE_OK && (code & 0xff) != SQLITE_FULL)
        return store->failed("cannot be synced", code);
    return store;
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
    lineage_ = sqlite::id_of(about.bytes(0));
    if (about.bytes(1) != options_.scene)
        return Error{ErrorCode::invalid_input, options_.file.string() + ": is the journal of scene " +
                                                   std::string{about.bytes(1)} + ", not of " +
                                                   options_.scene + ": name another folder"};
    forgotten_ = static_cast<Revision>(about.number(2));
    code = last.step();
    if (code != SQLITE_ROW && code != SQLITE_DONE) return failed("cannot be read", code);
    head_ = code == SQLITE_ROW ? static_cast<Revision>(last.number(0)) : forgotten_;
    newest_ = code == SQLITE_ROW ? sqlite::time_of(last.number(1)) : JournalTime{};
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
        if (read_.number(0) != sqlite::integer(next)) {
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

}  // namespace tessera
