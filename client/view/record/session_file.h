#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "shared/result/result.h"

namespace tessera::view {
class SessionEntry;
}

namespace tessera {

/// Writes the blocks of a recorded session (session.proto) on a thread of its own, so that no frame waits for
/// the disk. What was written stays good whatever happens next.
class SessionWriter {
  public:
    static constexpr std::uint64_t most_waiting_bytes = 256u << 20;

    /// Error: io_failure (cannot be written).
    static Result<std::unique_ptr<SessionWriter>> open(const std::filesystem::path& file);
    ~SessionWriter();  ///< Waits until all is written.
    SessionWriter(const SessionWriter&) = delete;
    SessionWriter& operator=(const SessionWriter&) = delete;

    /// False: it cannot be taken, since the disk is too slow or has failed; problem() says which. Nothing is
    /// taken from then on.
    bool add(const view::SessionEntry& entry);
    /// Of all blocks so far that are on disk or on their way, packed as far as that is known.
    std::uint64_t bytes() const;
    std::string problem() const;

  private:
    class Worker;
    explicit SessionWriter(std::unique_ptr<Worker> worker);
    std::unique_ptr<Worker> worker_;
};

/// Reads them.
class SessionReader {
  public:
    /// Error: invalid_input (no such file, none of these, or of another version, by name).
    static Result<SessionReader> open(const std::filesystem::path& file);

    /// Reads the next entry. False: there is none; how_it_ends() says whether the file is whole. Memory stays
    /// below what one block may take, whatever the file holds.
    bool next(view::SessionEntry& entry);

    /// Empty while there is more, or after an end; else where and how the file breaks off.
    const std::string& trouble() const { return trouble_; }

  private:
    SessionReader(std::filesystem::path file, std::ifstream stream)
        : file_{std::move(file)}, stream_{std::move(stream)} {}
    bool broken(const std::string& how);

    std::filesystem::path file_;
    std::ifstream stream_;
    std::uint64_t entries_ = 0;
    bool has_ended_ = false;
    std::string trouble_;
};

inline constexpr std::uint32_t session_version = 1;

}  // namespace tessera
