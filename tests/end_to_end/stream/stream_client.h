#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "proto/stream.pb.h"

namespace tessera::test {

/// A client of a stream, in one thread: what arrives is kept until it is asked for. No wait is longer than
/// ten seconds.
class StreamClient {
  public:
    using Case = proto::ServerMessage::MessageCase;

    explicit StreamClient(std::uint16_t port, const std::string& scene = "sprites",
                          const std::string& proxied_for = {}, int receive_buffer = 0)
        : socket_{io_} {
        namespace websocket = boost::beast::websocket;
        auto& tcp = socket_.next_layer();
        tcp.open(boost::asio::ip::tcp::v4());
        if (receive_buffer != 0)
            tcp.set_option(boost::asio::socket_base::receive_buffer_size{receive_buffer});
        tcp.connect({boost::asio::ip::address_v4::loopback(), port});
        tcp.set_option(boost::asio::ip::tcp::no_delay{true});
        socket_.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
            request.set(boost::beast::http::field::sec_websocket_protocol, "tessera.stream.1");
            if (!proxied_for.empty()) request.set("X-Forwarded-For", proxied_for);
        }));
        socket_.binary(true);
        socket_.auto_fragment(false);
        socket_.read_message_max(std::size_t{64} << 20);
        boost::system::error_code failure;
        socket_.handshake(response_, "127.0.0.1:" + std::to_string(port), "/scenes/" + scene + "/stream",
                          failure);
        open_ = !failure;
    }

    bool open() const { return open_; }
    unsigned status() const { return response_.result_int(); }
    boost::beast::websocket::stream<boost::asio::ip::tcp::socket>& socket() { return socket_; }

    void send(const proto::ClientMessage& message) { send_bytes(message.SerializeAsString()); }
    void send_bytes(const std::string& bytes) {
        boost::system::error_code failure;
        socket_.write(boost::asio::buffer(bytes), failure);
        open_ = open_ && !failure;
    }

    /// The next message; nothing when the stream has ended or the time is over.
    std::optional<proto::ServerMessage> receive(std::chrono::milliseconds time = std::chrono::seconds{10}) {
        if (open_ && !reading_) {
            reading_ = true;
            socket_.async_read(input_, [this](const boost::system::error_code& failure, std::size_t) {
                reading_ = false;
                failure_ = failure;
                if (failure) open_ = false;
            });
        }
        const auto until = std::chrono::steady_clock::now() + time;
        io_.restart();
        while (reading_ && std::chrono::steady_clock::now() < until) io_.run_one_until(until);
        if (reading_ || !open_) return std::nullopt;
        proto::ServerMessage message;
        const auto bytes = input_.cdata();
        last_bytes_ = bytes.size();
        if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) std::abort();
        input_.consume(bytes.size());
        return message;
    }
    /// The next message of this kind; what arrives before it is given to `others` (or dropped).
    std::optional<proto::ServerMessage> receive(
        Case kind, std::chrono::milliseconds time = std::chrono::seconds{10},
        const std::function<void(const proto::ServerMessage&)>& others = {}) {
        const auto until = std::chrono::steady_clock::now() + time;
        for (;;) {
            const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
                until - std::chrono::steady_clock::now());
            if (left.count() <= 0) return std::nullopt;
            auto message = receive(left);
            if (!message || message->message_case() == kind) return message;
            if (others) others(*message);
        }
    }

    std::optional<proto::ServerHello> hello(const proto::ClientHello& hello = {}) {
        proto::ClientMessage message;
        *message.mutable_hello() = hello;
        send(message);
        auto answer = receive(Case::kHello);
        if (!answer) return std::nullopt;
        return answer->hello();
    }
    void grant(std::uint32_t credits) {
        proto::ClientMessage message;
        message.mutable_credits()->set_pages(credits);
        send(message);
    }
    void watch(std::uint32_t level, std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1,
               std::optional<std::uint64_t> seen = {}) {
        proto::ClientMessage message;
        proto::Window& window = *message.mutable_windows()->add_windows();
        window.set_level(level);
        window.set_x0(x0);
        window.set_y0(y0);
        window.set_x1(x1);
        window.set_y1(y1);
        if (seen) message.mutable_windows()->set_seen_revision(*seen);
        send(message);
    }
    static proto::PageAsk& add_ask(proto::ClientMessage& message, std::uint32_t id, std::uint32_t level,
                                   std::int64_t x, std::int64_t y) {
        proto::PageAsk& ask = *message.mutable_ask()->add_asks();
        ask.set_id(id);
        ask.mutable_page()->set_level(level);
        ask.mutable_page()->set_x(x);
        ask.mutable_page()->set_y(y);
        return ask;
    }
    void ask(std::uint32_t id, std::uint32_t level, std::int64_t x, std::int64_t y,
             const std::string& format = {}) {
        proto::ClientMessage message;
        add_ask(message, id, level, x, y);
        message.mutable_ask()->mutable_options()->set_format(format);
        send(message);
    }

    /// How the stream ended, once receive() found its end.
    boost::beast::websocket::close_reason reason() const { return socket_.reason(); }
    const boost::system::error_code& failure() const { return failure_; }
    std::size_t last_bytes() const { return last_bytes_; }

  private:
    boost::asio::io_context io_;
    boost::beast::websocket::stream<boost::asio::ip::tcp::socket> socket_;
    boost::beast::websocket::response_type response_;
    boost::beast::flat_buffer input_;
    boost::system::error_code failure_;
    std::size_t last_bytes_ = 0;
    bool open_ = false, reading_ = false;
};

}  // namespace tessera::test
