#include "client/link/web_socket.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/websocket/error.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

namespace tessera {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr auto as_result = asio::as_tuple(asio::use_awaitable);

/// The seconds of a Retry-After field; dates, which our servers do not write, count as absent.
milliseconds seconds_in(beast::string_view field) {
    int seconds = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), seconds);
    if (error != std::errc{} || end != field.data() + field.size() || seconds < 0) return milliseconds{0};
    return std::chrono::seconds{std::min(seconds, 3600)};
}

/// Why the server did not upgrade the connection.
Error refusal(const std::string& where, unsigned status, std::string body) {
    constexpr std::size_t longest = 300;
    body.resize(std::min(body.size(), body.find('\n')));
    body.resize(std::min(body.size(), longest));
    // The server's own words go before ours
    const auto words = [&](const char* ours) {
        return where + ": " + (body.empty() ? ours : body) + " (status " + std::to_string(status) + ")";
    };
    if (status == 404)
        return {ErrorCode::no_such_scene, words("the server has no such scene, or no streams")};
    if (status == 429 || status == 503) return {ErrorCode::overloaded, words("the server is busy")};
    if (status == 401 || status == 403)
        return {ErrorCode::malformed_request, words("the server does not allow it")};
    return {ErrorCode::io_failure, words("the server opens no stream there")};
}

}  // namespace

WebSocket::WebSocket(asio::any_io_executor executor, ServerAddress server, WebSocketLimits limits)
    : server_{std::move(server)},
      limits_{limits},
      stream_{executor},
      watch_timer_{executor},
      buffer_{limits.message_bytes} {}

void WebSocket::close() { fail({ErrorCode::cancelled, server_.url() + ": closed"}); }

void WebSocket::fail(Error cause) {
    if (!cause_) cause_ = std::move(cause);
    over_ = true;
    watch_timer_.cancel();
    beast::get_lowest_layer(stream_).close();
}

Error WebSocket::describe(error_code error, std::string_view doing) {
    const std::string where = server_.url() + ": " + std::string{doing} + ": ";
    const auto made = [&]() -> Error {
        if (error == websocket::error::closed)
            return {ErrorCode::io_failure, where + "the server closed the stream without a goodbye"};
        if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow)
            return {ErrorCode::io_failure, where + "the server sent a message of more than " +
                                               std::to_string(limits_.message_bytes) + " bytes"};
        if (error == asio::error::eof || error == http::error::end_of_stream ||
            error == http::error::partial_message || error == asio::error::connection_reset)
            return {ErrorCode::io_failure, where + "the server closed the connection"};
        if (error == asio::error::connection_refused)
            return {ErrorCode::io_failure, where + error.message() + "; is the server running there?"};
        return {ErrorCode::io_failure, where + error.message()};
    };
    if (!cause_) fail(made());
    return *cause_;
}

std::optional<Error> WebSocket::overdue(Time now) const {
    const auto late = [&](const std::optional<Time>& since, milliseconds allowed, const char* what) {
        std::optional<Error> error;
        if (since && now - *since > allowed)
            error = Error{ErrorCode::timed_out,
                          server_.url() + ": " + what + " within " + std::to_string(allowed.count()) + " ms"};
        return error;
    };
    if (opening_) return late(opening_, limits_.open_timeout, "the stream was not opened");
    if (auto error = late(message_, limits_.message_timeout, "a message of the server's was not complete"))
        return error;
    if (auto error = late(writing_, limits_.write_timeout, "the server did not take a message")) return error;
    return late(heard_, limits_.silence_timeout, "nothing was heard from the server");
}

asio::awaitable<void> WebSocket::watch() {
    const auto self = shared_from_this();
    const milliseconds shortest = std::min(
        {limits_.open_timeout, limits_.message_timeout, limits_.silence_timeout, limits_.write_timeout});
    while (!over_) {
        const milliseconds tick = std::clamp(shortest / 8, milliseconds{1}, milliseconds{250});
        watch_timer_.expires_after(tick);
        const Time due = watch_timer_.expiry();
        co_await watch_timer_.async_wait(as_result);
        if (over_) co_return;
        const Time now = steady_clock::now();
        if (now - due > tick) excuse(now - due);
        if (auto error = overdue(now)) fail(std::move(*error));
    }
}

/// A program that was stopped, or a machine that was, says nothing about the server.
void WebSocket::excuse(steady_clock::duration stood_still) {
    heard_ += stood_still;
    for (std::optional<Time>* since : {&opening_, &message_, &writing_})
        if (*since) **since += stood_still;
}

asio::awaitable<Result<void>> WebSocket::open(std::string target, std::string subprotocol) {
    const auto self = shared_from_this();
    if (over_) co_return *cause_;
    opening_ = heard_ = steady_clock::now();
    asio::co_spawn(stream_.get_executor(), watch(), asio::detached);

    // The name look-up itself is bounded by the system's resolver
    tcp::resolver resolver{stream_.get_executor()};
    const auto [not_found, endpoints] =
        co_await resolver.async_resolve(server_.host, std::to_string(server_.port), as_result);
    if (over_) co_return *cause_;
    if (not_found) co_return describe(not_found, "looking up its name");
    auto& transport = beast::get_lowest_layer(stream_);
    const auto [no_connection, endpoint] = co_await transport.async_connect(endpoints, as_result);
    if (over_) co_return *cause_;
    if (no_connection) co_return describe(no_connection, "connecting");
    error_code ignored;
    transport.socket().set_option(tcp::no_delay{true}, ignored);

    // Timeouts are those of watch(), which knows what is under way
    stream_.set_option(websocket::stream_base::timeout{websocket::stream_base::none(),
                                                       websocket::stream_base::none(), false});
    stream_.read_message_max(limits_.message_bytes);
    stream_.binary(true);
    stream_.set_option(websocket::stream_base::decorator{[subprotocol](websocket::request_type& request) {
        request.set(http::field::user_agent, "tessera");
        request.set(http::field::sec_websocket_protocol, subprotocol);
    }});
    // Pings and closing frames are signs of life, too
    stream_.control_callback(
        [this](websocket::frame_type, beast::string_view) { heard_ = steady_clock::now(); });
    websocket::response_type response;
    const auto [refused] = co_await stream_.async_handshake(response, server_.authority(), target, as_result);
    opening_.reset();
    heard_ = steady_clock::now();
    if (over_) co_return *cause_;
    if (refused == websocket::error::upgrade_declined) {
        retry_after_ = seconds_in(response[http::field::retry_after]);
        fail(refusal(server_.url() + target, response.result_int(), std::move(response.body())));
        co_return *cause_;
    }
    if (refused) co_return describe(refused, "opening the stream");
    if (response[http::field::sec_websocket_protocol] != subprotocol) {
        fail({ErrorCode::io_failure, server_.url() + target + ": the server does not speak " + subprotocol});
        co_return *cause_;
    }
    co_return Result<void>{};
}

asio::awaitable<Result<std::string>> WebSocket::read() {
    const auto self = shared_from_this();
    constexpr std::size_t piece = 64 * 1024;
    buffer_.clear();
    do {
        if (over_) co_return *cause_;
        const auto [error, size] = co_await stream_.async_read_some(buffer_, piece, as_result);
        heard_ = steady_clock::now();
        bytes_received_ += size;
        if (error) co_return describe(error, "reading the stream");
        if (!message_) message_ = heard_;
    } while (!stream_.is_message_done());
    message_.reset();
    if (!stream_.got_binary()) {
        fail({ErrorCode::io_failure, server_.url() + ": the server sent text where messages are binary"});
        co_return *cause_;
    }
    co_return beast::buffers_to_string(buffer_.cdata());
}

asio::awaitable<Result<void>> WebSocket::write(std::string_view bytes) {
    const auto self = shared_from_this();
    if (over_) co_return *cause_;
    writing_ = steady_clock::now();
    const auto [error, size] = co_await stream_.async_write(asio::buffer(bytes), as_result);
    writing_.reset();
    if (error) co_return describe(error, "writing to the stream");
    co_return Result<void>{};
}

}  // namespace tessera
