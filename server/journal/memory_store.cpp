#include "server/journal/memory_store.h"

namespace tessera {

JournalStore::Done MemoryStore::commit(std::span<const Edit> edits, Revision forget) {
    for (const Edit& edit : edits) {
        revisions_.emplace(edit.id, edit.revision);
        bytes_ += stored_bytes(edit);
        newest_ = edit.accepted;
        edits_.push_back(edit);
    }
    for (; forgotten_ < forget; ++forgotten_) {
        revisions_.erase(edits_.front().id);
        bytes_ -= stored_bytes(edits_.front());
        edits_.pop_front();
    }
    return std::nullopt;
}

Result<std::optional<Edit>> MemoryStore::find(const EditId& id) {
    const auto found = revisions_.find(id);
    return found == revisions_.end() ? std::nullopt : std::optional{at(found->second)};
}

Result<std::vector<Edit>> MemoryStore::read(Revision from, std::size_t edits, std::size_t bytes) {
    std::vector<Edit> history;
    for (std::size_t sum = 0; from <= head() && history.size() < edits; ++from) {
        sum += at(from).bytes.size();
        if (!history.empty() && sum > bytes) break;
        history.push_back(at(from));
    }
    return history;
}

std::vector<Revision> MemorySnapshots::revisions() const {
    std::vector<Revision> revisions;
    for (const Snapshot& snapshot : snapshots_) revisions.push_back(snapshot.revision);
    return revisions;
}

Result<void> MemorySnapshots::keep(const Snapshot& snapshot) {
    snapshots_.push_back(snapshot);
    if (snapshots_.size() > 2) snapshots_.pop_front();
    return {};
}

Result<std::optional<Snapshot>> MemorySnapshots::newest(Revision at_most) {
    for (auto snapshot = snapshots_.rbegin(); snapshot != snapshots_.rend(); ++snapshot) {
        if (snapshot->revision <= at_most) return std::optional{*snapshot};
    }
    return std::optional<Snapshot>{};
}

}  // namespace tessera
