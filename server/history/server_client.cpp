#include "server/history/server_client.h"

#include <chrono>
#include <thread>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

#include "proto/page.pb.h"

#include "shared/wire/json.h"

namespace tessera {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

constexpr std::chrono::seconds patience{30};
constexpr std::uint64_t max_answer_bytes = std::uint64_t{4} << 20;
constexpr int tries = 3;
constexpr std::string_view protobuf = "application/x-protobuf";

/// One request and its answer; each step begins the next.
class Exchange {
  public:
    Exchange(asio::io_context& io, http::request<http::string_body> request)
        : resolver_{io}, stream_{io}, request_{std::move(request)} {
        parser_.body_limit(max_answer_bytes);
    }

    void start(const std::string& host, const std::string& port) {
        stream_.expires_after(patience);
        resolver_.async_resolve(host, port, [this](beast::error_code failed, const auto& places) {
            if (failed) return fail(failed);
            stream_.async_connect(places, [this](beast::error_code failed_too, const auto&) {
                if (failed_too) return fail(failed_too);
                write();
            });
        });
    }

    beast::error_code error;
    const http::response<http::string_body>& answer() const { return parser_.get(); }

  private:
    void fail(beast::error_code failed) { error = failed; }
    void write() {
        http::async_write(stream_, request_, [this](beast::error_code, std::size_t) {
            // A refusal may come before all is sent
            http::async_read(stream_, buffer_, parser_, [this](beast::error_code failed, std::size_t) {
                if (failed) fail(failed);
            });
        });
    }

    asio::ip::tcp::resolver resolver_;
    beast::tcp_stream stream_;
    http::request<http::string_body> request_;
    beast::flat_buffer buffer_;
    http::response_parser<http::string_body> parser_;
};

/// The server's own words, one line.
Error refused(const std::string& words) {
    return {ErrorCode::invalid_input, "the server refuses it: " + words.substr(0, words.find('\n'))};
}

}  // namespace

Result<ServerClient> ServerClient::of(const std::string& address, std::string token) {
    const Error wrong{ErrorCode::invalid_input,
                      "--server " + address + ": write the server's address as http://HOST:PORT"};
    constexpr std::string_view scheme = "http://";
    if (!address.starts_with(scheme)) return wrong;
    std::string rest = address.substr(scheme.size());
    while (rest.ends_with('/')) rest.pop_back();
    const std::size_t bracket = rest.rfind(']'), colon = rest.rfind(':');
    const bool has_port = colon != std::string::npos && (bracket == std::string::npos || colon > bracket);
    std::string host = rest.substr(0, has_port ? colon : std::string::npos);
    std::string port = has_port ? rest.substr(colon + 1) : "80";
    if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
    if (host.empty() || host.find_first_of("/?#@[] \t\r\n") != std::string::npos || port.empty() ||
        port.find_first_not_of("0123456789") != std::string::npos)
        return wrong;
    if (token.find_first_of("\r\n") != std::string::npos)
        return Error{ErrorCode::invalid_input, "TESSERA_TOKEN: holds more than a line"};
    return ServerClient{std::move(host), std::move(port), std::move(token)};
}

std::string ServerClient::address() const {
    return "http://" + (host_.find(':') == std::string::npos ? host_ : "[" + host_ + "]") + ":" + port_;
}

Result<ServerClient::Reply> ServerClient::ask(bool post, const std::string& target,
                                              const std::string& body) const {
    http::request<http::string_body> request{post ? http::verb::post : http::verb::get, target, 11};
    request.set(http::field::host, address().substr(7));
    request.set(http::field::connection, "close");
    if (!token_.empty()) request.set(http::field::authorization, "Bearer " + token_);
    if (post) {
        request.set(http::field::content_type, boost::string_view{protobuf.data(), protobuf.size()});
        request.body() = body;
    }
    request.prepare_payload();
    asio::io_context io;
    Exchange exchange{io, std::move(request)};
    exchange.start(host_, port_);
    io.run_for(patience + std::chrono::seconds{1});
    if (!io.stopped()) exchange.error = beast::error::timeout;
    if (exchange.error) return Error{ErrorCode::io_failure, address() + ": " + exchange.error.message()};
    return Reply{exchange.answer().result_int(), exchange.answer().body()};
}

Result<std::string> ServerClient::fingerprint(const std::string& scene) const {
    const auto reply = ask(false, "/scenes/" + scene, {});
    if (!reply) return reply.error();
    if (reply->status != 200) return refused(reply->body);
    proto::TileJson description;
    const auto read = read_json_leniently(reply->body, address(), description);
    if (!read || description.tessera().fingerprint().empty())
        return Error{ErrorCode::invalid_input, address() + ": is not a server of ours"};
    return description.tessera().fingerprint();
}

Result<proto::EditAnswer> ServerClient::edit(const std::string& scene, const proto::Edit& edit) const {
    const std::string body = edit.SerializeAsString();
    Error last;
    for (int i = 0; i < tries; ++i) {
        if (i > 0) std::this_thread::sleep_for(std::chrono::seconds{i});
        const auto reply = ask(true, "/scenes/" + scene + "/edits", body);
        if (!reply) {
            last = reply.error();
            continue;
        }
        proto::EditAnswer answer;
        if (reply->status == 200 && answer.ParseFromString(reply->body)) return answer;
        // Passing, or its fate is not known: the id tells them apart
        if (reply->status != 503) return refused(reply->body);
        last = refused(reply->body);
    }
    return last;
}

}  // namespace tessera
