#pragma once

#include <cstdint>
#include <cstdio>
#include <optional>

#include "server/journal/journal.h"
#include "server/progress/progress.h"

namespace tessera {

struct LogOptions {
    std::optional<Revision> from{};  ///< None: the newest `limit`.
    std::uint64_t limit = 100;       ///< 0: all.
    bool json = false;               ///< An object a line.
};

/// Writes a line for each edit that the journal remembers and that is asked for, the oldest first: revision,
/// time, author and what it does. Returns how many older ones were left out. Errors: invalid_input, where
/// `from` is beyond the journal's horizon; io_failure; cancelled.
Result<Revision> write_log(Journal& journal, const LogOptions& options, std::FILE* out, Progress& progress);

}  // namespace tessera
