#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace tessera::sqlite {

/// A prepared statement. Parameters count from 1, columns from 0. What text and bytes point at outlives the
/// step, and a column's view ends with the next step.
class Statement {
  public:
    Statement() = default;
    Statement(Statement&&) noexcept = default;
    Statement& operator=(Statement&&) noexcept = default;

    Statement& bind(int parameter, std::int64_t number);
    Statement& bind(int parameter, std::span<const std::uint8_t> bytes);
    Statement& bind(int parameter, std::string_view text);
    Statement& bind_bytes(int parameter, std::string_view bytes);

    /// SQLITE_ROW, SQLITE_DONE, or what went wrong (extended code).
    int step();
    void reset();
    /// Steps a statement without rows to its end, and resets it: SQLITE_OK, or what went wrong.
    int run();

    std::int64_t number(int column) const;
    std::string_view bytes(int column) const;  ///< Of text as well.

  private:
    friend class Connection;
    struct Finalize {
        void operator()(sqlite3_stmt* statement) const noexcept;
    };
    std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// An open database file, used by one thread.
class Connection {
  public:
    /// SQLITE_OK, or what went wrong. `vfs` empty: the system's.
    int open(const std::string& path, const std::string& vfs);
    /// Every statement is gone by then. SQLITE_OK, or what went wrong.
    int close();
    bool is_open() const noexcept { return database_ != nullptr; }

    int prepare(std::string_view sql, Statement& statement);
    /// Runs statements whose rows do not matter: SQLITE_OK, or what went wrong.
    int execute(const char* sql);
    /// The first column of the first row, as text; empty if there is none or `code` says what went wrong.
    std::string ask(std::string_view sql, int& code);

    std::string message() const;  ///< Of the last failure.
    sqlite3* handle() const noexcept { return database_.get(); }

  private:
    struct Close {
        void operator()(sqlite3* database) const noexcept;
    };
    std::unique_ptr<sqlite3, Close> database_;
};

}  // namespace tessera::sqlite
