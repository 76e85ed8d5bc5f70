#include "tests/unit/client/link/small_stream_server.h"

#include <utility>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <zstd.h>

namespace tessera::test {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using asio::ip::tcp;

namespace {
constexpr auto as_result = asio::as_tuple(asio::use_awaitable);
}

asio::awaitable<std::optional<proto::ClientMessage>> StreamPeer::hear() {
    buffer.clear();
    const auto [error, size] = co_await stream.async_read(buffer, as_result);
    if (error) co_return std::nullopt;
    proto::ClientMessage message;
    if (!message.ParseFromArray(buffer.cdata().data(), static_cast<int>(buffer.size())))
        co_return std::nullopt;
    co_return message;
}

asio::awaitable<std::optional<proto::ClientMessage>> StreamPeer::hear(
    proto::ClientMessage::MessageCase kind) {
    for (;;) {
        auto message = co_await hear();
        if (!message || message->message_case() == kind) co_return message;
        if (message->has_ping()) {
            proto::ServerMessage pong;
            pong.mutable_pong()->set_payload(message->ping().payload());
            co_await say(pong);
        }
    }
}

asio::awaitable<void> StreamPeer::say(proto::ServerMessage message) {
    co_await say_bytes(message.SerializeAsString());
}

asio::awaitable<void> StreamPeer::say_bytes(std::string bytes) {
    co_await stream.async_write(asio::buffer(bytes), as_result);
}

asio::awaitable<void> StreamPeer::say_raw(std::string bytes) {
    co_await asio::async_write(stream.next_layer(), asio::buffer(bytes), as_result);
}

asio::awaitable<void> StreamPeer::wait(std::chrono::milliseconds time) {
    asio::steady_timer timer{stream.get_executor(), time};
    co_await timer.async_wait(as_result);
}

asio::awaitable<proto::ClientHello> StreamPeer::greet(std::function<void(proto::ServerHello&)> change) {
    const auto heard = co_await hear();
    proto::ServerMessage answer;
    *answer.mutable_hello() = small_hello();
    if (change) change(*answer.mutable_hello());
    co_await say(answer);
    proto::ClientHello hello;
    if (heard) hello = heard->hello();
    co_return hello;
}

asio::awaitable<void> StreamPeer::stay() {
    for (;;) {  // GCC 12 never leaves a while whose condition awaits a temporary
        const auto message = co_await hear(proto::ClientMessage::MESSAGE_NOT_SET);
        if (!message) co_return;
    }
}

SmallStreamServer::SmallStreamServer(Script script, Refusal refusal)
    : script_{std::move(script)},
      refusal_{std::move(refusal)},
      acceptor_{context_, {asio::ip::address_v4::loopback(), 0}},
      port_{acceptor_.local_endpoint().port()} {
    asio::co_spawn(context_, accept(), asio::detached);
    thread_ = std::thread{[this] { context_.run(); }};
}

SmallStreamServer::~SmallStreamServer() {
    context_.stop();
    thread_.join();
}

asio::awaitable<void> SmallStreamServer::accept() {
    for (;;) {
        auto [error, socket] = co_await acceptor_.async_accept(as_result);
        if (error) co_return;
        asio::co_spawn(context_, serve(std::move(socket), connections_++), asio::detached);
    }
}

asio::awaitable<void> SmallStreamServer::serve(tcp::socket socket, int n) {
    socket.set_option(tcp::no_delay{true});
    beast::flat_buffer buffer;
    beast::http::request<beast::http::string_body> request;
    const auto [no_request, size] = co_await beast::http::async_read(socket, buffer, request, as_result);
    if (no_request) co_return;
    if (refusal_) {
        if (const std::string refusal = refusal_(n); !refusal.empty()) {
            co_await asio::async_write(socket, asio::buffer(refusal), as_result);
            co_return;
        }
    }
    StreamPeer peer{std::move(socket)};
    peer.stream.binary(true);
    peer.stream.set_option(websocket::stream_base::decorator{[](websocket::response_type& response) {
        response.set(beast::http::field::sec_websocket_protocol, "tessera.stream.1");
    }});
    const auto [no_upgrade] = co_await peer.stream.async_accept(request, as_result);
    if (no_upgrade) co_return;
    co_await script_(peer, n);
}

proto::ServerHello small_hello() {
    proto::ServerHello hello;
    hello.set_scene("checker");
    hello.set_title("A checker");
    hello.set_revision(7);
    hello.set_lineage("one");
    hello.set_fingerprint("abc");
    hello.set_extent_log2_pages(6);
    hello.set_session(3);
    hello.set_may_edit(true);
    hello.set_takes_edits(true);
    proto::StreamLimits& limits = *hello.mutable_limits();
    limits.set_windows(64);
    limits.set_window_pages(16384);
    limits.set_asks(1024);
    limits.set_credits(1024);
    limits.set_message_bytes(256 * 1024);
    return hello;
}

proto::ServerMessage small_page(const proto::PageAsk& ask, char value, std::uint64_t revision) {
    const std::string texels(std::size_t{4} * 256 * 256, value);
    std::string packed(ZSTD_compressBound(texels.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), texels.data(), texels.size(), 1));
    proto::ServerMessage message;
    proto::PageData& page = *message.mutable_page();
    page.set_id(ask.id());
    *page.mutable_page() = ask.page();
    page.set_revision(revision);
    page.set_scene_revision(std::max<std::uint64_t>({7, revision, ask.least_revision()}));
    page.set_tag("tag");
    page.set_texels(packed);
    return message;
}

}  // namespace tessera::test
