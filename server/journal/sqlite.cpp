#include "server/journal/sqlite.h"

#include <sqlite3.h>

namespace tessera::sqlite {

void Statement::Finalize::operator()(sqlite3_stmt* statement) const noexcept { sqlite3_finalize(statement); }
void Connection::Close::operator()(sqlite3* database) const noexcept { sqlite3_close_v2(database); }

Statement& Statement::bind(int parameter, std::int64_t number) {
    sqlite3_bind_int64(statement_.get(), parameter, number);
    return *this;
}

Statement& Statement::bind(int parameter, std::span<const std::uint8_t> bytes) {
    sqlite3_bind_blob64(statement_.get(), parameter, bytes.data(), bytes.size(), SQLITE_STATIC);
    return *this;
}

Statement& Statement::bind(int parameter, std::string_view text) {
    sqlite3_bind_text64(statement_.get(), parameter, text.data(), text.size(), SQLITE_STATIC, SQLITE_UTF8);
    return *this;
}

Statement& Statement::bind_bytes(int parameter, std::string_view bytes) {
    // A null pointer would be bound as NULL, not as no bytes
    sqlite3_bind_blob64(statement_.get(), parameter, bytes.empty() ? "" : bytes.data(), bytes.size(),
                        SQLITE_STATIC);
    return *this;
}

int Statement::step() { return sqlite3_step(statement_.get()); }
void Statement::reset() { sqlite3_reset(statement_.get()); }

int Statement::run() {
    int code = SQLITE_ROW;
    while (code == SQLITE_ROW) code = step();
    reset();
    return code == SQLITE_DONE ? SQLITE_OK : code;
}

std::int64_t Statement::number(int column) const { return sqlite3_column_int64(statement_.get(), column); }

std::string_view Statement::bytes(int column) const {
    const void* const bytes = sqlite3_column_blob(statement_.get(), column);
    const int count = sqlite3_column_bytes(statement_.get(), column);
    return bytes == nullptr
               ? std::string_view{}
               : std::string_view{static_cast<const char*>(bytes), static_cast<std::size_t>(count)};
}

int Connection::open(const std::string& path, const std::string& vfs) {
    sqlite3* database = nullptr;
    const int code = sqlite3_open_v2(path.c_str(), &database,
                                     SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX |
                                         SQLITE_OPEN_EXRESCODE | SQLITE_OPEN_PRIVATECACHE,
                                     vfs.empty() ? nullptr : vfs.c_str());
    database_.reset(database);
    return code;
}

int Connection::close() {
    const int code = sqlite3_close(database_.get());
    if (code == SQLITE_OK) static_cast<void>(database_.release());
    database_.reset();
    return code;
}

int Connection::prepare(std::string_view sql, Statement& statement) {
    sqlite3_stmt* made = nullptr;
    const int code = sqlite3_prepare_v3(database_.get(), sql.data(), static_cast<int>(sql.size()),
                                        SQLITE_PREPARE_PERSISTENT, &made, nullptr);
    statement.statement_.reset(made);
    return code;
}

int Connection::execute(const char* sql) {
    return sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr);
}

std::string Connection::ask(std::string_view sql, int& code) {
    Statement statement;
    code = prepare(sql, statement);
    if (code != SQLITE_OK) return {};
    const int step = statement.step();
    if (step != SQLITE_ROW && step != SQLITE_DONE) code = step;
    return step == SQLITE_ROW ? std::string{statement.bytes(0)} : std::string{};
}

std::string Connection::message() const {
    if (database_ == nullptr) return "out of memory";
    return sqlite3_errmsg(database_.get());
}

}  // namespace tessera::sqlite
