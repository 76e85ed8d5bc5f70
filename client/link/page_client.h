#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/any_io_executor.hpp>

#include "client/link/http_connection.h"
#include "client/link/page_url.h"
#include "client/link/scene_info.h"
#include "shared/page/page_key.h"
#include "shared/result/result.h"

namespace tessera {

struct PageClientSettings {
    /// Requests on the wire at once. Too few leave the server idle while answers travel; browsers take 6.
    std::size_t connections = 6;
    /// Requests that may wait for a connection; more fail at once with `overloaded`. A long queue is full of
    /// requests that nobody wants any more by the time they are sent.
    std::size_t max_queued = 256;
    /// Tries for one page while the server is overloaded or away, the first included.
    int attempts = 4;
    /// The wait before the second try; it doubles with each. A longer Retry-After goes first.
    std::chrono::milliseconds first_back_off{100};
    /// No wait is longer, whatever Retry-After says.
    std::chrono::milliseconds longest_back_off{10000};
    /// How long a cancelled request may still stay on the wire before its connection is closed.
    std::chrono::milliseconds cancel_grace{20};
    HttpLimits limits;
};

struct PageReply {
    PageKey page;
    FetchOptions options;
    /// rgba: rows from the top, 4·(256 + 2·gutter)² bytes, checked. Else the file as the format has it.
    std::string bytes;
    std::string etag;                  ///< Strong, in its quotes; empty where the server gives none.
    std::chrono::microseconds took{};  ///< From get() to the whole answer: waiting and retries included.
};

/// Counts since the start; the last two are of now.
struct PageClientStatistics {
    std::uint64_t requested = 0;
    std::uint64_t succeeded = 0;
    std::uint64_t failed = 0;
    std::uint64_t cancelled = 0;
    std::uint64_t retried = 0;  ///< Tries after the first.
    std::uint64_t connections_opened = 0;
    std::uint64_t bytes_received = 0;  ///< On the wire, headers included.
    std::uint64_t bytes_delivered = 0;
    std::size_t waiting = 0;  ///< Queued, or backing off.
    std::size_t on_the_wire = 0;
};

using RequestId = std::uint64_t;  ///< Never used twice by one client; 0 names no request.

/// Fetches pages of one scene over a few connections, the longest waiting first. Lives on one strand (or one
/// thread's io_context), and all calls and completions happen there.
class PageClient {
  public:
    using Completion = std::function<void(RequestId, Result<PageReply>)>;

    PageClient(boost::asio::any_io_executor executor, ServerAddress server, SceneInfo scene,
               PageClientSettings settings = {});
    ~PageClient();  ///< Closes the connections; what is under way is forgotten without a completion.
    PageClient(const PageClient&) = delete;
    PageClient& operator=(const PageClient&) = delete;

    /// Asks for a page. `completion` is called exactly once, never from within get() or cancel(). Errors: the
    /// ErrorCodes of HttpConnection::get and `malformed_request`, `no_such_page` (outside the extent; gone
    /// from the server), `page_changed`, `overloaded` (still so after all tries, or the queue is full).
    RequestId get(PageKey page, const FetchOptions& options, Completion completion);

    /// The request ends with `cancelled`, soon. Nothing happens if it has ended.
    void cancel(RequestId id);
    void cancel_all();

    PageClientStatistics statistics() const;

  private:
    class State;
    std::shared_ptr<State> state_;  // the connections' coroutines hold it while an operation winds down
};

}  // namespace tessera
