#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/edits/live_scene.h"
#include "server/stream/edit_news.h"
#include "server/stream/page_socket.h"
#include "server/stream/presence_board.h"
#include "shared/revisions/edit_id.h"

namespace tessera {

class StreamSession;

/// The sessions of one scene on one I/O thread: woken together, by one message however much has happened.
class Audience : public std::enable_shared_from_this<Audience> {
  public:
    explicit Audience(IoExecutor executor) : executor_{std::move(executor)} {}

    /// From any thread: every session looks for what is new. Does nothing while one is on its way.
    void wake();

    std::vector<StreamSession*> sessions;  ///< On the executor's thread only.

  private:
    const IoExecutor executor_;
    std::atomic<bool> woken_ = false;
};

/// What the streams of one scene share: who listens, who is here, and the last edits. All members may be
/// called from any thread.
class SceneHub {
  public:
    /// Listens to this scene's edits from now on; null: to none.
    void follow(const std::shared_ptr<LiveScene>& live);

    std::shared_ptr<Audience> add_audience(IoExecutor executor);
    void wake();

    /// Who makes an edit that is under way, so that the others can be told.
    void edit_begins(const EditId& edit, std::uint64_t session);
    void edit_ends(const EditId& edit);

    PresenceBoard presence;
    EditNewsRing news;
    std::atomic<int> news_readers = 0;  ///< None: no news are made.

  private:
    void take(const std::vector<LiveScene::Change>& changes);
    EditNewsPtr news_of(const LiveScene::Change& change);

    std::mutex mutex_;  ///< Guards what follows.
    std::vector<std::shared_ptr<Audience>> audiences_;
    std::unordered_map<EditId, std::uint64_t> makers_;
    std::weak_ptr<LiveScene> live_;
    std::shared_ptr<void> listening_;
};

}  // namespace tessera
