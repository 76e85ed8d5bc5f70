#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/fields.hpp>

#include "client/link/server_address.h"
#include "shared/result/result.h"

namespace tessera {

using HttpFields = boost::beast::http::fields;

/// What one answer may cost. Too little refuses honest answers; too much lets a broken server hold us up.
struct HttpLimits {
    std::uint32_t header_bytes = 16 * 1024;
    std::uint64_t body_bytes = 8 * 1024 * 1024;  ///< A raw page with the widest gutter takes 324 KB.
    std::chrono::milliseconds connect_timeout{5000};
    std::chrono::milliseconds request_timeout{30000};  ///< From the first byte sent to the last received.
};

struct HttpReply {
    unsigned status = 0;
    HttpFields fields;
    std::string body;  ///< As it came: a content encoding is not undone.

    /// The field's value, or "" if it is not there.
    std::string_view field(std::string_view name) const;
};

/// One keep-alive connection to a server, opened when it is first needed, and again after either side closed
/// it. One request at a time. Lives on one strand; must outlive the requests it runs.
class HttpConnection {
  public:
    HttpConnection(boost::asio::any_io_executor executor, ServerAddress server, HttpLimits limits = {});

    /// GETs `target` (path and query, already encoded) with `fields` beside Host and User-Agent. Any status
    /// is a value. Errors: `timed_out`, `cancelled` (after close(), or through Asio's cancellation),
    /// `io_failure` (cannot connect, connection lost, an answer beyond the limits or not HTTP).
    /// Asks a second time, once, if a connection that had been idle turns out to be closed by the server.
    boost::asio::awaitable<Result<HttpReply>> get(std::string_view target, const HttpFields& fields = {});

    /// Closes the connection; a running get() ends soon with `cancelled`. The next get() opens a new one.
    void close();

    bool is_open() const noexcept { return is_open_; }
    /// Connections opened so far.
    std::uint64_t opened() const noexcept { return opened_; }
    /// Bytes of answers received, headers included.
    std::uint64_t bytes_received() const noexcept { return bytes_received_; }
    const ServerAddress& server() const noexcept { return server_; }

  private:
    struct Attempt;
    boost::asio::awaitable<Result<HttpReply>> get_or_reconnect(std::string_view target,
                                                               const HttpFields& fields);
    boost::asio::awaitable<boost::system::error_code> open();
    boost::asio::awaitable<Attempt> attempt(std::string_view target, const HttpFields& fields);
    Error describe(boost::system::error_code error, std::string_view doing) const;

    ServerAddress server_;
    std::string authority_;
    HttpLimits limits_;
    boost::beast::tcp_stream stream_;
    boost::beast::flat_buffer buffer_;
    bool is_open_ = false;
    bool closed_by_us_ = false;
    std::uint64_t opened_ = 0;
    std::uint64_t bytes_received_ = 0;
};

}  // namespace tessera
