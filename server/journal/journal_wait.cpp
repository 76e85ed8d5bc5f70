#include "server/journal/journal_wait.h"

#include <future>

namespace tessera {
namespace {

/// What `ask` hands to the handler that it is given.
template <class Answer, class Ask>
Answer wait_for(const Ask& ask) {
    const auto promise = std::make_shared<std::promise<Answer>>();
    std::future<Answer> future = promise->get_future();
    [[maybe_unused]] const auto ticket =
        ask([promise](Answer answer) { promise->set_value(std::move(answer)); });
    return future.get();
}

}  // namespace

std::vector<AppendOutcome> append_and_wait(Journal& journal, std::vector<Append> batch) {
    return wait_for<std::vector<AppendOutcome>>([&](auto handler) {
        journal.append(std::move(batch), std::move(handler));
        return 0;
    });
}

AppendOutcome append_and_wait(Journal& journal, Append edit) {
    return wait_for<AppendOutcome>([&](auto handler) {
        journal.append(std::move(edit), std::move(handler));
        return 0;
    });
}

Result<std::optional<Revision>> find_and_wait(Journal& journal, EditId id) {
    return *wait_for<std::optional<Result<std::optional<Revision>>>>([&](auto handler) {
        journal.find(id, std::move(handler));
        return 0;
    });
}

Result<void> keep_snapshot_and_wait(Journal& journal, Snapshot snapshot) {
    return *wait_for<std::optional<Result<void>>>([&](auto handler) {
        journal.keep_snapshot(std::move(snapshot), std::move(handler));
        return 0;
    });
}

Result<std::optional<Snapshot>> newest_snapshot_and_wait(Journal& journal, Revision at_most) {
    return *wait_for<std::optional<Result<std::optional<Snapshot>>>>([&](auto handler) {
        journal.newest_snapshot(at_most, std::move(handler));
        return 0;
    });
}

std::optional<History> for_each_edit(Journal& journal, Revision from, Revision through,
                                     const std::function<bool(const Edit&)>& take) {
    while (from <= through) {
        History history =
            wait_for<History>([&](auto handler) { return journal.follow(from, std::move(handler)); });
        const auto* const edits = std::get_if<std::vector<Edit>>(&history);
        if (edits == nullptr) return history;
        for (const Edit& edit : *edits) {
            if (edit.revision > through || !take(edit)) return std::nullopt;
        }
        from = edits->back().revision + 1;
    }
    return std::nullopt;
}

}  // namespace tessera
