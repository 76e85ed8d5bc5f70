#pragma once

#include "server/journal/journal.h"

namespace tessera {

/// The journal's members for callers that may wait: commands, recovery, tests. Not for a handler.
AppendOutcome append_and_wait(Journal& journal, Append edit);
std::vector<AppendOutcome> append_and_wait(Journal& journal, std::vector<Append> batch);
Result<std::optional<Revision>> find_and_wait(Journal& journal, EditId id);
Result<void> keep_snapshot_and_wait(Journal& journal, Snapshot snapshot);
Result<std::optional<Snapshot>> newest_snapshot_and_wait(Journal& journal, Revision at_most = ~Revision{0});

/// The edits from `from` to `through`, in order, one call of `take` for each: why it ended early, if it did.
/// Both revisions must be remembered; `take` stops it by returning false.
std::optional<History> for_each_edit(Journal& journal, Revision from, Revision through,
                                     const std::function<bool(const Edit&)>& take);

}  // namespace tessera
