#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "server/journal/journal_store.h"

namespace tessera {

/// Writes and reads snapshots on a thread of its own, in the order in which they are asked for. Bounded: what
/// is asked for while many wait is refused. All functions may be called from any thread.
class SnapshotKeeper {
  public:
    /// Revisions of the snapshots that are there, oldest first.
    using Changed = std::function<void(const std::vector<Revision>&)>;
    /// `changed` is called on the keeper's thread after each attempt to write, before it is answered.
    SnapshotKeeper(std::unique_ptr<SnapshotStore> store, Changed changed);
    /// Answers all that was asked for.
    ~SnapshotKeeper();

    /// `head`: the journal's. Errors: overloaded; malformed_request unless newer than the last snapshot, and
    /// not newer than the head.
    void keep(Snapshot snapshot, Revision head, Journal::Handler<Result<void>> handler);
    void newest(Revision at_most, Journal::Handler<Result<std::optional<Snapshot>>> handler);

    /// Takes no more, and answers all that was asked for.
    void close();

  private:
    void run();

    const Changed changed_;
    std::mutex mutex_;  ///< Guards what follows; never held while waiting for the disk or a handler.
    std::condition_variable work_arrived_;
    std::deque<std::function<void()>> work_;
    std::vector<Revision> revisions_;
    bool closing_ = false;

    std::unique_ptr<SnapshotStore> store_;  ///< Used by the thread alone.
    std::jthread thread_;                   ///< Last: it uses everything above.
};

}  // namespace tessera
