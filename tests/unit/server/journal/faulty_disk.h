#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace tessera::tests {

/// A disk that fails as it is told, between SQLite and the system's: name() is an SQLite VFS. One at a time.
class FaultyDisk {
  public:
    enum class Kind { write, sync, truncate, open };

    FaultyDisk();
    ~FaultyDisk();
    FaultyDisk(const FaultyDisk&) = delete;
    FaultyDisk& operator=(const FaultyDisk&) = delete;
    static const char* name() { return "tessera-faulty"; }

    /// The `number`th operation from now on (1 is the next) fails, and `more` after it. `done`: it happens
    /// all the same, and only its answer is a failure. With a kind, operations of this kind count alone.
    void fail(std::uint64_t number, std::uint64_t more = 0, bool done = false, std::optional<Kind> kind = {});
    void heal();
    /// Files may not grow beyond so many bytes together: no room.
    void set_room(std::optional<std::uint64_t> bytes);
    std::uint64_t operations() const;

    /// From the `number`th operation on nothing reaches the disk, and everything fails.
    void lose_power(std::uint64_t number);
    /// What the files hold after it: what was synced, and of what was written since any part, torn or not.
    /// Nobody has them open.
    void power_comes_back(std::uint64_t seed);

    struct File;

  private:
    friend struct FaultyDiskCalls;
    struct Write {
        std::int64_t offset = 0;
        std::string bytes;
        bool truncation = false;  ///< To `offset`.
    };
    /// What of a file is on the disk, and what waits for a sync, in memory. A sync that fails drops what
    /// waits: the file seems to have it, and does not, as on Linux.
    struct Content {
        std::string durable;
        std::vector<Write> waiting;
    };
    static void apply(const Write& write, std::string& content);
    /// What becomes of an operation: nothing is 0; else SQLite's code, and whether it is done all the same.
    struct Fate {
        int code = 0;
        bool done = true;
    };
    Fate fate(Kind kind);

    mutable std::mutex mutex_;
    std::uint64_t operations_ = 0;
    std::uint64_t fail_at_ = 0, fail_more_ = 0, power_lost_at_ = 0;
    bool fail_done_ = false;
    std::optional<Kind> fail_kind_;
    std::optional<std::uint64_t> room_;
    std::map<std::string, Content> files_;
    std::map<std::string, std::int64_t> sizes_;
};

}  // namespace tessera::tests
