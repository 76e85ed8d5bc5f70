#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "client/link/page_client.h"

namespace tessera {

/// A page that has come, or the reason why it has not.
struct FinishedPage {
    RequestId id = 0;
    PageKey page;
    FetchOptions options;
    Result<PageReply> result;
};

/// A PageClient on a thread of its own, for callers that must not wait. Every call is safe from any thread,
/// and none but wait_for_finished() waits.
class BackgroundPageClient {
  public:
    /// `max_outstanding`: requests that have not been taken by take_finished() yet; it bounds the memory
    /// here.
    BackgroundPageClient(ServerAddress server, SceneInfo scene, PageClientSettings settings = {},
                         std::size_t max_outstanding = 256);
    ~BackgroundPageClient();  ///< Closes the connections, forgets what is under way, joins the thread.
    BackgroundPageClient(const BackgroundPageClient&) = delete;
    BackgroundPageClient& operator=(const BackgroundPageClient&) = delete;

    /// Starts a request; nothing if `max_outstanding` are out already.
    std::optional<RequestId> request(PageKey page, const FetchOptions& options = {});

    /// The request will come back as finished with `cancelled`, or with its page if that was faster.
    void cancel(RequestId id);
    void cancel_all();

    /// Up to `most` finished requests, in the order in which they ended.
    std::vector<FinishedPage> take_finished(std::size_t most = static_cast<std::size_t>(-1));

    /// Waits until take_finished() has something to give, or `timeout` has passed; true in the first case.
    bool wait_for_finished(std::chrono::milliseconds timeout);

    /// Requests that have not been taken by take_finished() yet.
    std::size_t outstanding() const;

    /// As of the last request that ended.
    PageClientStatistics statistics() const;

  private:
    class Worker;
    std::unique_ptr<Worker> worker_;
};

}  // namespace tessera
