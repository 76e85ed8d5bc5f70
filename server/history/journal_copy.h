#pragma once

#include <filesystem>
#include <memory>

#include "server/files/whole_file.h"
#include "server/journal/journal.h"
#include "server/progress/progress.h"

namespace tessera {

/// A scene's journal as it was at one moment, for reading. It may belong to a server that runs: its files are
/// read without a lock, so that nothing ever waits for us, and nothing is written beside them.
class JournalCopy {
  public:
    /// Copies the journal in `folder` to a temporary folder, and opens that. Errors: io_failure,
    /// invalid_input in the journal's words, cancelled; io_failure also where the journal changes faster than
    /// it can be copied.
    static Result<JournalCopy> take(const std::filesystem::path& folder, const std::string& scene,
                                    Progress& progress);

    Journal& journal() const noexcept { return *journal_; }

  private:
    JournalCopy(std::unique_ptr<RemovedAtEnd> copy, std::unique_ptr<Journal> journal)
        : copy_{std::move(copy)}, journal_{std::move(journal)} {}

    std::unique_ptr<RemovedAtEnd> copy_;
    std::unique_ptr<Journal> journal_;  ///< Closed before its files are removed.
};

}  // namespace tessera
