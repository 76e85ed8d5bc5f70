#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "proto/stream.pb.h"

#include "client/link/server_address.h"

namespace tessera::test {

/// One client of a SmallStreamServer, after the upgrade.
class StreamPeer {
  public:
    explicit StreamPeer(boost::asio::ip::tcp::socket socket) : stream{std::move(socket)} {}

    /// The next message; nothing when the client has gone.
    boost::asio::awaitable<std::optional<proto::ClientMessage>> hear();
    /// The next message of this kind; others are passed over.
    boost::asio::awaitable<std::optional<proto::ClientMessage>> hear(proto::ClientMessage::MessageCase kind);
    boost::asio::awaitable<void> say(proto::ServerMessage message);
    boost::asio::awaitable<void> say_bytes(std::string bytes);
    /// Bytes past the WebSocket: half a frame, garbage.
    boost::asio::awaitable<void> say_raw(std::string bytes);
    boost::asio::awaitable<void> wait(std::chrono::milliseconds time);
    /// Hears the client's hello and answers it.
    boost::asio::awaitable<proto::ClientHello> greet(std::function<void(proto::ServerHello&)> change = {});
    /// Until the client goes.
    boost::asio::awaitable<void> stay();

    boost::beast::websocket::stream<boost::asio::ip::tcp::socket> stream;
    boost::beast::flat_buffer buffer;
};

/// A WebSocket server for tests, on 127.0.0.1 and a port of its own, that does what the test tells it to.
class SmallStreamServer {
  public:
    /// One connection, from the upgrade to its closing; `n` counts them from 0.
    using Script = std::function<boost::asio::awaitable<void>(StreamPeer&, int n)>;
    /// What is sent in place of the upgrade of the n-th connection; empty: it is upgraded.
    using Refusal = std::function<std::string(int n)>;

    explicit SmallStreamServer(Script script, Refusal refusal = {});
    ~SmallStreamServer();

    ServerAddress address() const { return {"127.0.0.1", port_}; }
    int connections() const { return connections_; }

  private:
    boost::asio::awaitable<void> accept();
    boost::asio::awaitable<void> serve(boost::asio::ip::tcp::socket socket, int n);

    Script script_;
    Refusal refusal_;
    boost::asio::io_context context_{1};
    boost::asio::ip::tcp::acceptor acceptor_;
    std::uint16_t port_ = 0;
    std::atomic<int> connections_ = 0;
    std::thread thread_;
};

/// As a server of a scene of 256·2^6 texels that takes edits would say it.
proto::ServerHello small_hello();

/// The answer to an ask with a page of one byte value, gutter 0, packed.
proto::ServerMessage small_page(const proto::PageAsk& ask, char value, std::uint64_t revision = 0);

}  // namespace tessera::test
