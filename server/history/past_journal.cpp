#include "server/history/past_journal.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "server/journal/journal_wait.h"

namespace tessera {

Result<void> check_remembered(Journal& journal, Revision revision) {
    const JournalStatus status = journal.status();
    const auto invalid = [&](const std::string& why) {
        return Error{ErrorCode::invalid_input, "revision " + std::to_string(revision) + " " + why};
    };
    if (revision > status.head)
        return invalid("is not reached; the scene is at revision " + std::to_string(status.head));
    const auto snapshot = newest_snapshot_and_wait(journal, revision);
    if (!snapshot) return snapshot.error();
    const Revision begin = *snapshot ? (*snapshot)->revision : 0;
    if (begin + 1 < status.oldest)
        return invalid("is beyond the journal's horizon; the oldest edit that it remembers is revision " +
                       std::to_string(status.oldest));
    return {};
}

Result<std::unique_ptr<PastJournal>> PastJournal::at(Journal& journal, Revision last) {
    if (auto remembered = check_remembered(journal, last); !remembered) return remembered.error();
    return std::unique_ptr<PastJournal>{new PastJournal{journal, last}};
}

void PastJournal::append(std::vector<Append> batch, Handler<std::vector<AppendOutcome>> handler) {
    std::vector<AppendOutcome> outcomes;
    for (std::size_t i = 0; i < batch.size(); ++i) outcomes.push_back(Accepted{++head_, false});
    handler(std::move(outcomes));
}

void PastJournal::find(EditId id, Handler<Result<std::optional<Revision>>> handler) {
    journal_.find(id, std::move(handler));
}

Journal::Ticket PastJournal::follow(Revision from, Handler<History> handler) {
    return journal_.follow(from, [last = last_, handler = std::move(handler)](History history) {
        if (auto* edits = std::get_if<std::vector<Edit>>(&history))
            std::erase_if(*edits, [&](const Edit& edit) { return edit.revision > last; });
        handler(std::move(history));
    });
}

void PastJournal::keep_snapshot(Snapshot, Handler<Result<void>> handler) { handler({}); }

void PastJournal::newest_snapshot(Revision at_most, Handler<Result<std::optional<Snapshot>>> handler) {
    journal_.newest_snapshot(std::min(at_most, last_), std::move(handler));
}

JournalStatus PastJournal::status() const {
    JournalStatus status = journal_.status();
    status.head = head_;
    status.snapshot = std::min(status.snapshot, last_);
    status.snapshot_due = false;
    return status;
}

}  // namespace tessera
