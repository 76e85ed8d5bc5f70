#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "client/link/server_address.h"
#include "shared/result/result.h"

namespace tessera {

/// What a connection may cost. Too little loses honest servers on slow lines; too much lets a broken one hold
/// us up.
struct WebSocketLimits {
    std::size_t message_bytes = 4 * 1024 * 1024;       ///< A raw page with the widest gutter takes 324 KB.
    std::chrono::milliseconds open_timeout{10000};     ///< From connecting to the upgrade.
    std::chrono::milliseconds message_timeout{20000};  ///< From a message's first byte to its last.
    std::chrono::milliseconds silence_timeout{15000};  ///< Without a byte of the server's.
    std::chrono::milliseconds write_timeout{15000};    ///< For a message of ours.
};

/// One WebSocket that carries binary messages, from its opening to its end. At most one read() and one
/// write() at a time; all on one strand. Every error says in words what happened, and the first one is the
/// cause that all later calls return.
class WebSocket : public std::enable_shared_from_this<WebSocket> {
  public:
    WebSocket(boost::asio::any_io_executor executor, ServerAddress server, WebSocketLimits limits);

    /// Connects and upgrades. The server has to speak `subprotocol`. Errors: `no_such_scene` (status 404),
    /// `overloaded` (429, 503), `malformed_request` (401, 403: not allowed), `timed_out`, `cancelled`,
    /// `io_failure`.
    boost::asio::awaitable<Result<void>> open(std::string target, std::string subprotocol);

    /// The next message. Errors: `timed_out`, `cancelled` (after close()), `io_failure`.
    boost::asio::awaitable<Result<std::string>> read();

    /// Sends a message; `bytes` stays until then. Errors as read().
    boost::asio::awaitable<Result<void>> write(std::string_view bytes);

    /// Ends the connection at once; what runs ends soon, with `cancelled`.
    void close();
    /// The same, and what runs ends with this error.
    void fail(Error cause);

    bool is_over() const noexcept { return over_; }
    /// What the server asked for when it refused the upgrade; 0: nothing.
    std::chrono::milliseconds retry_after() const noexcept { return retry_after_; }
    std::uint64_t bytes_received() const noexcept { return bytes_received_; }

  private:
    using Time = std::chrono::steady_clock::time_point;
    boost::asio::awaitable<void> watch();
    std::optional<Error> overdue(Time now) const;
    void excuse(std::chrono::steady_clock::duration stood_still);
    Error describe(boost::system::error_code error, std::string_view doing);

    ServerAddress server_;
    WebSocketLimits limits_;
    boost::beast::websocket::stream<boost::beast::tcp_stream> stream_;
    boost::asio::steady_timer watch_timer_;
    boost::beast::flat_buffer buffer_;
    bool over_ = false;
    std::optional<Error> cause_;
    std::chrono::milliseconds retry_after_{0};
    std::uint64_t bytes_received_ = 0;
    // Since when what is under way is under way
    std::optional<Time> opening_, message_, writing_;
    Time heard_{};
};

}  // namespace tessera
