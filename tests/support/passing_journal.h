#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "server/journal/journal.h"

namespace tessera::tests {

/// A journal that a scene may own while the test keeps it, for the next scene that is opened on it.
class PassingJournal : public Journal {
  public:
    explicit PassingJournal(std::shared_ptr<Journal> journal) : journal_{std::move(journal)} {}

    using Journal::append;
    void append(std::vector<Append> batch, Handler<std::vector<AppendOutcome>> handler) override {
        journal_->append(std::move(batch), std::move(handler));
    }
    void find(EditId id, Handler<Result<std::optional<Revision>>> handler) override {
        journal_->find(id, std::move(handler));
    }
    Ticket follow(Revision from, Handler<History> handler) override {
        return journal_->follow(from, std::move(handler));
    }
    void keep_snapshot(Snapshot snapshot, Handler<Result<void>> handler) override {
        journal_->keep_snapshot(std::move(snapshot), std::move(handler));
    }
    void newest_snapshot(Revision at_most, Handler<Result<std::optional<Snapshot>>> handler) override {
        journal_->newest_snapshot(at_most, std::move(handler));
    }
    JournalStatus status() const override { return journal_->status(); }

  private:
    std::shared_ptr<Journal> journal_;
};

}  // namespace tessera::tests
