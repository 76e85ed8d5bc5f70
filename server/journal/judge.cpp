#include "server/journal/judge.h"

namespace tessera {

std::optional<AppendOutcome> judge(const Append& edit, const Standing& standing, std::size_t edit_bytes) {
    // A retry first: what the edit hoped for does not matter once it is in
    if (standing.same_id != nullptr) {
        if (standing.same_id->bytes == edit.bytes) return Accepted{standing.same_id->revision, true};
        return Refused{RefusalReason::other_content, "edit " + to_string(edit.id) +
                                                         " was accepted as revision " +
                                                         std::to_string(standing.same_id->revision) +
                                                         " with other content: draw a new id for a new edit"};
    }
    if (edit.bytes.size() > edit_bytes)
        return Refused{RefusalReason::too_large, "the edit has " + std::to_string(edit.bytes.size()) +
                                                     " bytes, more than " + std::to_string(edit_bytes)};

    if (edit.expected && *edit.expected != standing.head) return Conflict{standing.head};

    // A forgotten edit of this id would be newer than all that its client knew
    if (edit.known < standing.forgotten)
        return Refused{RefusalReason::outside_horizon,
                       "the edit was made at revision " + std::to_string(edit.known) +
                           "; whether it was accepted since is only known for revisions after " +
                           std::to_string(standing.forgotten) +
                           ": read the present state, and send what is missing under a new id"};
    if (edit.known > standing.head)
        return Refused{RefusalReason::outside_horizon,
                       "the edit was made at revision " + std::to_string(edit.known) +
                           ", but the newest is " + std::to_string(standing.head) +
                           ": read the present state again"};
    return std::nullopt;
}

}  // namespace tessera
