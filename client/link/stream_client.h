#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>

#include "proto/stream.pb.h"

#include "client/link/page_url.h"
#include "client/link/pending_edits.h"
#include "client/link/server_address.h"
#include "client/link/stream_page.h"
#include "client/link/web_socket.h"
#include "shared/result/result.h"

namespace tessera {

struct StreamSettings {
    std::string name;   ///< For people, at most 64 bytes.
    std::string token;  ///< Of an editor; empty: none.
    bool wants_presence = false;
    bool wants_edits = false;  ///< To be told every edit of others.
    /// Of all pages. The format is rgba.
    FetchOptions options{.format = PageFormat::rgba};

    /// Asks that are not answered; the server may allow fewer.
    std::size_t max_asks = 256;
    /// An ask that waits longer ends with `timed_out`.
    std::chrono::milliseconds answer_timeout{30000};
    /// The server has to answer within this that it has dropped an ask; the stream is left once half of
    /// `max_asks` have waited longer.
    std::chrono::milliseconds cancel_timeout{10000};
    /// Edits whose fate is not known.
    std::size_t max_edits = 1024;
    /// How long an edit may wait for its fate before it ends as unknown; unset: for ever.
    std::optional<std::chrono::milliseconds> edit_patience;

    std::chrono::milliseconds hello_timeout{10000};  ///< For the server's first message.
    std::chrono::milliseconds ping_every{2000};      ///< Measures the round trip, and that the server lives.
    /// The wait before a connection is tried again; it doubles while none lasts for `steady_after`.
    std::chrono::milliseconds first_back_off{100};
    std::chrono::milliseconds longest_back_off{10000};
    std::chrono::milliseconds steady_after{5000};
    WebSocketLimits limits;
};

/// What a stream tells. All calls are made on the client's strand, none from within a call to the client.
class StreamListener {
  public:
    virtual ~StreamListener() = default;
    /// The stream is open, or its scene was replaced. hello.resumed(): all that was known is still right, but
    /// for the invalidations that follow. Else every page may be another.
    virtual void on_open(const proto::ServerHello& /*hello*/) {}
    /// The stream is lost, or could not be opened, and will be tried again.
    virtual void on_lost(const Error& /*why*/, std::chrono::milliseconds /*retry_in*/) {}
    /// Every ask ends here, exactly once; with an error when the stream is lost.
    virtual void on_page(StreamPage /*page*/) {}
    virtual void on_invalidation(const proto::Invalidation& /*invalidation*/) {}
    /// Of others.
    virtual void on_edit(const proto::EditDone& /*edit*/) {}
    virtual void on_present(const proto::Present& /*present*/) {}
    virtual void on_clock(const proto::ClockNow& /*clock*/) {}
};

/// Counts since the start; the last three are of now.
struct StreamStatistics {
    std::uint64_t connections = 0;  ///< Opened, with a hello.
    std::uint64_t resumed = 0;
    std::uint64_t pages = 0;
    std::uint64_t pages_refused = 0;  ///< By the server, cancelled ones apart.
    std::uint64_t mistakes = 0;       ///< Answers of the server's that were wrong, doubled or not asked for.
    std::uint64_t edits_sent_again = 0;
    std::uint64_t bytes_received = 0;
    std::chrono::microseconds round_trip{0};  ///< Smoothed; 0: not measured yet.
    std::size_t asks = 0;
    std::int64_t credits = 0;  ///< That the server has left.
};

/// One stream of one scene, opened again with back-off whenever it is lost: goes on where it was, asks
/// the server to tell what changed meanwhile, and sends edits again whose fate is not known. Lives on one
/// strand (or one thread's io_context), and all calls and callbacks happen there. Whatever the server sends,
/// memory stays below what the settings allow.
class StreamClient {
  public:
    /// Starts connecting. `listener` outlives the client.
    StreamClient(boost::asio::any_io_executor executor, ServerAddress server, const std::string& scene,
                 StreamSettings settings, StreamListener& listener);
    /// Closes the stream. What is under way is forgotten, and nobody is called.
    ~StreamClient();
    StreamClient(const StreamClient&) = delete;
    StreamClient& operator=(const StreamClient&) = delete;

    bool is_open() const;

    /// False: too many asks, no connection, or an ask of that id waits for its answer.
    bool ask(const StreamAsk& ask);
    /// The ask ends with `cancelled`, or with its page if that was faster.
    void cancel(std::uint32_t id);
    /// How many pages the server may send ahead of being asked for more, 0 to 1024; at first 0.
    void allow(std::uint32_t pages);

    /// Replaces all windows. The pages that the caller has there and that were in no window before have seen
    /// all edits up to `seen_revision`. Windows beyond the server's limits are left out from the end.
    void watch(std::vector<proto::Window> windows, std::uint64_t seen_revision);

    /// Sends an edit until its fate is known; `done` is called once with it, never from within edit(). Draws
    /// an id and a known revision if it has none. Returns the id; "": too many edits wait, `done` is not
    /// called.
    std::string edit(proto::Edit edit, PendingEdits::Completion done);

    /// What others see of this client from now on.
    void be_present(const proto::Presence& presence);

    /// The newest revision of the scene that was heard of.
    std::uint64_t newest_revision() const;
    StreamStatistics statistics() const;

  private:
    class State;
    std::shared_ptr<State> state_;  // the connection's coroutines hold it while an operation winds down
};

}  // namespace tessera
