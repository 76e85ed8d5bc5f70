#include "client/link/http_connection.h"

#include <optional>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>

namespace tessera {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using boost::system::error_code;

namespace {
constexpr auto as_result = asio::as_tuple(asio::use_awaitable);
}

/// How one try on the wire ended. `was_stale`: the server had closed the idle connection before it saw the
/// request.
struct HttpConnection::Attempt {
    error_code error;
    std::string_view doing;
    bool was_stale = false;
    HttpReply reply;
};

std::string_view HttpReply::field(std::string_view name) const {
    const auto found = fields.find({name.data(), name.size()});
    if (found == fields.end()) return {};
    return {found->value().data(), found->value().size()};
}

HttpConnection::HttpConnection(asio::any_io_executor executor, ServerAddress server, HttpLimits limits)
    : server_{std::move(server)},
      authority_{server_.authority()},
      limits_{limits},
      stream_{std::move(executor)} {}

void HttpConnection::close() {
    closed_by_us_ = true;
    is_open_ = false;
    stream_.close();
}

Error HttpConnection::describe(error_code error, std::string_view doing) const {
    const std::string where = server_.url() + ": " + std::string{doing};
    if (closed_by_us_ || error == asio::error::operation_aborted)
        return {ErrorCode::cancelled, where + ": cancelled"};
    if (error == beast::error::timeout) return {ErrorCode::timed_out, where + ": no answer in time"};
    if (error == http::error::body_limit || error == http::error::header_limit ||
        error == http::error::buffer_overflow)
        return {ErrorCode::io_failure,
                where + ": the answer is longer than the limit (" + error.message() + ")"};
    if (error == http::error::end_of_stream || error == http::error::partial_message)
        return {ErrorCode::io_failure,
                where + ": the server closed the connection before its answer was complete"};
    if (error == asio::error::connection_refused)
        return {ErrorCode::io_failure, where + ": " + error.message() + "; is the server running there?"};
    return {ErrorCode::io_failure, where + ": " + error.message()};
}

asio::awaitable<error_code> HttpConnection::open() {
    const auto executor = stream_.get_executor();
    tcp::resolver resolver{executor};
    // The name look-up itself is bounded by the system's resolver
    const auto [not_found, endpoints] =
        co_await resolver.async_resolve(server_.host, std::to_string(server_.port), as_result);
    if (not_found) co_return not_found;
    const auto cancellation = co_await asio::this_coro::cancellation_state;
    if (closed_by_us_ || cancellation.cancelled() != asio::cancellation_type::none)
        co_return error_code{asio::error::operation_aborted};
    stream_.expires_after(limits_.connect_timeout);
    const auto [error, endpoint] = co_await stream_.async_connect(endpoints, as_result);
    if (error) co_return error;
    error_code ignored;
    stream_.socket().set_option(tcp::no_delay{true}, ignored);
    buffer_.clear();
    is_open_ = true;
    ++opened_;
    co_return error_code{};
}

asio::awaitable<HttpConnection::Attempt> HttpConnection::attempt(std::string_view target,
                                                                 const HttpFields& fields) {
    Attempt attempt;
    std::string request = "GET ";
    request.append(target)
        .append(" HTTP/1.1\r\nHost: ")
        .append(authority_)
        .append("\r\nUser-Agent: tessera\r\n");
    for (const auto& field : fields) {
        const auto name = field.name_string(), value = field.value();
        request.append(name.data(), name.size())
            .append(": ")
            .append(value.data(), value.size())
            .append("\r\n");
    }
    request.append("\r\n");

    stream_.expires_after(limits_.request_timeout);
    attempt.doing = "sending the request";
    const auto [send_error, sent] = co_await asio::async_write(stream_, asio::buffer(request), as_result);
    if (send_error) {
        attempt.error = send_error;
        attempt.was_stale = true;
        co_return attempt;
    }

    attempt.doing = "reading the answer";
    http::response_parser<http::string_body> parser;
    parser.header_limit(limits_.header_bytes);
    parser.body_limit(limits_.body_bytes);
    const auto [read_error, received] = co_await http::async_read(stream_, buffer_, parser, as_result);
    bytes_received_ += received;
    if (read_error) {
        attempt.error = read_error;
        attempt.was_stale = received == 0 && buffer_.size() == 0 && read_error != beast::error::timeout;
        co_return attempt;
    }
    if (!parser.keep_alive() && is_open_) {
        is_open_ = false;
        stream_.close();
    }
    auto message = parser.release();
    attempt.reply.status = message.result_int();
    attempt.reply.body = std::move(message.body());
    attempt.reply.fields = std::move(message.base());
    co_return attempt;
}

asio::awaitable<Result<HttpReply>> HttpConnection::get(std::string_view target, const HttpFields& fields) {
    // Cancellation ends the operation under way and comes back as its error; our caller keeps its own habit
    const bool throws = co_await asio::this_coro::throw_if_cancelled();
    co_await asio::this_coro::throw_if_cancelled(false);
    Result<HttpReply> reply = co_await get_or_reconnect(target, fields);
    co_await asio::this_coro::throw_if_cancelled(throws);
    co_return reply;
}

asio::awaitable<Result<HttpReply>> HttpConnection::get_or_reconnect(std::string_view target,
                                                                    const HttpFields& fields) {
    closed_by_us_ = false;
    for (;;) {
        const bool was_idle = is_open_;
        if (!is_open_) {
            if (const error_code error = co_await open()) {
                stream_.close();
                co_return describe(error, "connecting");
            }
        }
        Attempt tried = co_await attempt(target, fields);
        if (!tried.error) {
            stream_.expires_never();
            co_return std::move(tried.reply);
        }
        is_open_ = false;
        stream_.close();
        if (was_idle && tried.was_stale && !closed_by_us_ && tried.error != asio::error::operation_aborted)
            continue;
        co_return describe(tried.error, tried.doing);
    }
}

}  // namespace tessera
