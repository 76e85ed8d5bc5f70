#pragma once

#include "server/journal/journal.h"

namespace tessera {

/// A journal as it was after a revision: a scene that is opened on it is the scene of that time. What is
/// appended goes nowhere but into the count.
class PastJournal final : public Journal {
  public:
    /// `journal` outlives this. Error: invalid_input, where `last` is newer than its head, or the state of
    /// then is beyond its horizon.
    static Result<std::unique_ptr<PastJournal>> at(Journal& journal, Revision last);

    using Journal::append;
    void append(std::vector<Append> batch, Handler<std::vector<AppendOutcome>> handler) override;
    void find(EditId id, Handler<Result<std::optional<Revision>>> handler) override;
    Ticket follow(Revision from, Handler<History> handler) override;
    void keep_snapshot(Snapshot snapshot, Handler<Result<void>> handler) override;
    void newest_snapshot(Revision at_most, Handler<Result<std::optional<Snapshot>>> handler) override;
    JournalStatus status() const override;

  private:
    PastJournal(Journal& journal, Revision last) : journal_{journal}, last_{last}, head_{last} {}

    Journal& journal_;
    const Revision last_;
    Revision head_;  ///< With what was appended.
};

/// "revision 3 is beyond …": why the journal cannot tell the state after a revision; nothing if it can.
Result<void> check_remembered(Journal& journal, Revision revision);

}  // namespace tessera
