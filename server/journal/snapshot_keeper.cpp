#include "server/journal/snapshot_keeper.h"

#include <string>
#include <utility>

namespace tessera {
namespace {

constexpr std::size_t most_waiting = 16;

}  // namespace

SnapshotKeeper::SnapshotKeeper(std::unique_ptr<SnapshotStore> store, Changed changed)
    : changed_{std::move(changed)}, revisions_{store->revisions()}, store_{std::move(store)} {
    thread_ = std::jthread{[this] { run(); }};
}

SnapshotKeeper::~SnapshotKeeper() { close(); }

void SnapshotKeeper::close() {
    {
        const std::lock_guard lock{mutex_};
        closing_ = true;
    }
    work_arrived_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void SnapshotKeeper::keep(Snapshot snapshot, Revision head, Journal::Handler<Result<void>> handler) {
    // std::function wants to be copied: the snapshot is shared, not copied
    auto shared = std::make_shared<Snapshot>(std::move(snapshot));
    std::optional<Error> error;
    {
        const std::lock_guard lock{mutex_};
        const Revision newest = revisions_.empty() ? 0 : revisions_.back();
        if (closing_ || work_.size() >= most_waiting) {
            error =
                Error{ErrorCode::overloaded, "another snapshot is being written, or the journal is closed"};
        } else if (shared->revision > head || shared->revision <= newest) {
            error = Error{ErrorCode::malformed_request,
                          "a snapshot of revision " + std::to_string(shared->revision) +
                              " must be newer than the last one, " + std::to_string(newest) +
                              ", and not newer than the head, " + std::to_string(head)};
        } else {
            work_.emplace_back([this, shared, handler] {
                const Result<void> kept = store_->keep(*shared);
                std::vector<Revision> there = store_->revisions();
                changed_(there);
                {
                    const std::lock_guard again{mutex_};
                    revisions_ = std::move(there);
                }
                handler(kept);
            });
        }
    }
    if (error) return handler(*error);
    work_arrived_.notify_one();
}

void SnapshotKeeper::newest(Revision at_most, Journal::Handler<Result<std::optional<Snapshot>>> handler) {
    {
        const std::lock_guard lock{mutex_};
        if (!closing_ && work_.size() < most_waiting) {
            work_.emplace_back(
                [this, at_most, handler = std::move(handler)] { handler(store_->newest(at_most)); });
            work_arrived_.notify_one();
            return;
        }
    }
    handler(Error{ErrorCode::overloaded, "too many snapshots are asked for, or the journal is closed"});
}

void SnapshotKeeper::run() {
    for (;;) {
        std::function<void()> work;
        {
            std::unique_lock lock{mutex_};
            work_arrived_.wait(lock, [this] { return !work_.empty() || closing_; });
            if (work_.empty()) return;
            work = std::move(work_.front());
            work_.pop_front();
        }
        work();
    }
}

}  // namespace tessera
