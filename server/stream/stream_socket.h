#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "server/stream/page_socket.h"
#include "server/stream/stream_options.h"
#include "server/stream/watched_socket.h"

namespace tessera {

/// What a StreamSocket tells, on its I/O thread.
class StreamEnd {
  public:
    virtual ~StreamEnd() = default;
    virtual void opened() = 0;
    /// A message; the socket reads on when read_on() is called.
    virtual void received(std::string_view message) = 0;
    virtual void sent() = 0;  ///< What was given to send() has left, and the next may follow.
    /// The connection is gone, or is no use any more. Called once, with the reason for the log; `cut`: for
    /// what the client did or did not do.
    virtual void ended(std::string_view why, bool cut) = 0;
};

/// A WebSocket that carries binary messages, one at a time each way, and ends when its client does not read,
/// does not answer, or sends what it should not. On one I/O thread.
class StreamSocket {
  public:
    using Clock = WatchedSocket::Clock;
    using Upgrade = boost::beast::http::request<boost::beast::http::empty_body>;

    StreamSocket(PageSocket socket, const StreamOptions& options);

    /// Answers the upgrade, which passed all checks, then calls opened(). `end` is kept alive by what is
    /// under way.
    void accept(const Upgrade& upgrade, const std::shared_ptr<StreamEnd>& end);
    void read_on();

    /// Whether send() may be called.
    bool ready() const noexcept { return open_ && !writing_ && !closing_ && !ended_; }
    /// `owner` keeps `body` alive until sent().
    void send(std::string head, std::span<const std::uint8_t> body = {},
              std::shared_ptr<const void> owner = {});

    /// Says goodbye with a close code, and ends. send() has nothing under way.
    void close(unsigned code, std::string_view why);
    void abort();

    /// Ends what waits longer than it may. Called a few times a second.
    void check(Clock::time_point now);

  private:
    void end(std::string_view why);
    void cut();
    void heard();

    boost::beast::websocket::stream<WatchedSocket, false> socket_;
    const StreamOptions& options_;
    std::weak_ptr<StreamEnd> end_;
    boost::beast::flat_buffer input_;
    std::string head_;
    std::span<const std::uint8_t> body_;
    std::shared_ptr<const void> owner_;
    bool open_ = false, writing_ = false, pinging_ = false, closing_ = false, ended_ = false, cut_ = false;
    bool pinged_ = false;  ///< And not heard of since.
    std::size_t control_frames_ = 0;
    Clock::time_point second_begun_{}, heard_at_{}, pinged_at_{}, write_begun_{}, close_by_{};
};

}  // namespace tessera
