#pragma once

#include <optional>

#include "server/journal/journal.h"

namespace tessera {

/// What a journal knows when it decides about an edit.
struct Standing {
    Revision head = 0;
    Revision forgotten = 0;         ///< Edits up to this one are gone, and so are their ids.
    const Edit* same_id = nullptr;  ///< The accepted edit of that id, if there is one.
};

/// Every engine's rules: what becomes of `edit`, or nothing if it is to be accepted.
std::optional<AppendOutcome> judge(const Append& edit, const Standing& standing, std::size_t edit_bytes);

}  // namespace tessera
