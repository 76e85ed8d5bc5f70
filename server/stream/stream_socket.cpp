#include "server/stream/stream_socket.h"

#include <algorithm>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace tessera {
namespace {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

/// What the kernel keeps for a reader that is slow: news must not wait behind megabytes of pages.
constexpr int unsent_bytes = 128 << 10;

/// A client that sent a large message once need not keep room for another.
constexpr std::size_t kept_input_bytes = 4096;

/// Whole messages, and each in as few writes as the socket allows.
constexpr std::size_t write_buffer_bytes = 512;

std::string_view text_of(const boost::system::error_code& failure, std::string& room) {
    room = failure.message();
    return room;
}

}  // namespace

StreamSocket::StreamSocket(PageSocket socket, const StreamOptions& options)
    : socket_{WatchedSocket{std::move(socket)}}, options_{options} {
    setsockopt(socket_.next_layer().native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent_bytes,
               sizeof unsent_bytes);
    socket_.binary(true);
    socket_.auto_fragment(false);
    socket_.write_buffer_bytes(write_buffer_bytes);
    socket_.read_message_max(options.message_bytes);
    socket_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
        response.set(beast::http::field::sec_websocket_protocol, "tessera.stream.1");
        response.set(beast::http::field::server, "tessera");
    }));
}

void StreamSocket::accept(const Upgrade& upgrade, const std::shared_ptr<StreamEnd>& end) {
    end_ = end;
    heard_at_ = Clock::now();
    close_by_ = heard_at_ + options_.hello_time;
    socket_.control_callback([this](websocket::frame_type, beast::string_view) {
        heard();
        const auto now = Clock::now();
        if (now - second_begun_ >= std::chrono::seconds{1}) {
            second_begun_ = now;
            control_frames_ = 0;
        }
        if (++control_frames_ > options_.control_frames) cut();
    });
    socket_.async_accept(upgrade, [this, end](const boost::system::error_code& failure) {
        if (failure) return this->end("the handshake failed");
        open_ = true;
        close_by_ = Clock::time_point::max();
        end->opened();
    });
}

void StreamSocket::read_on() {
    if (ended_) return;
    input_.consume(input_.size());
    if (input_.capacity() > kept_input_bytes) input_.shrink_to_fit();
    socket_.async_read(input_,
                       [this, end = end_.lock()](const boost::system::error_code& failure, std::size_t) {
                           if (failure == websocket::error::closed) return this->end("the client left");
                           if (failure) {
                               std::string room;
                               return this->end(text_of(failure, room));
                           }
                           heard();
                           if (closing_) return read_on();  // nothing but the end matters any more
                           cut_ = cut_ || socket_.got_text();
                           if (socket_.got_text())
                               return close(websocket::close_code::unknown_data, "messages are binary");
                           const auto bytes = input_.cdata();
                           end->received({static_cast<const char*>(bytes.data()), bytes.size()});
                       });
}

void StreamSocket::send(std::string head, std::span<const std::uint8_t> body,
                        std::shared_ptr<const void> owner) {
    head_ = std::move(head);
    body_ = body;
    owner_ = std::move(owner);
    writing_ = true;
    write_begun_ = Clock::now();
    const std::array<boost::asio::const_buffer, 2> buffers{
        boost::asio::buffer(head_), boost::asio::const_buffer{body_.data(), body_.size()}};
    socket_.async_write(buffers,
                        [this, end = end_.lock()](const boost::system::error_code& failure, std::size_t) {
                            writing_ = false;
                            owner_.reset();
                            if (failure) {
                                std::string room;
                                return this->end(text_of(failure, room));
                            }
                            end->sent();
                        });
}

void StreamSocket::close(unsigned code, std::string_view why) {
    if (ended_ || std::exchange(closing_, true)) return;
    close_by_ = Clock::now() + options_.close_time;
    if (!open_) return abort();
    const websocket::close_reason reason{
        static_cast<websocket::close_code>(code),
        beast::string_view{why.data(), std::min<std::size_t>(why.size(), 120)}};
    socket_.async_close(reason,
                        [this, end = end_.lock()](const boost::system::error_code&) { this->end("closed"); });
}

void StreamSocket::abort() {
    boost::system::error_code ignored;
    socket_.next_layer().close(ignored);
}

void StreamSocket::end(std::string_view why) {
    if (std::exchange(ended_, true)) return;
    abort();
    if (const auto end = end_.lock()) end->ended(why, cut_);
}

void StreamSocket::cut() {
    cut_ = true;
    abort();
}

void StreamSocket::heard() {
    heard_at_ = Clock::now();
    pinged_ = false;
}

void StreamSocket::check(Clock::time_point now) {
    if (ended_) return;
    if (now >= close_by_) return abort();
    if (!open_) return;
    // Beast closes by itself what breaks the rules; it waits for the client's answer without a limit
    if (!closing_ && !socket_.is_open()) {
        closing_ = cut_ = true;
        close_by_ = now + options_.close_time;
        return;
    }
    const auto last_write = std::max(write_begun_, socket_.next_layer().last_write);
    if (writing_ && now - last_write > options_.write_time) return cut();
    if (closing_) return;
    if (pinged_) {
        // Behind much data on a slow way a ping takes its time
        if (now - std::max(pinged_at_, last_write) > options_.pong_time) cut();
    } else if (now - heard_at_ > options_.ping_time && !pinging_) {
        pinging_ = pinged_ = true;
        pinged_at_ = now;
        socket_.async_ping({},
                           [this, end = end_.lock()](const boost::system::error_code&) { pinging_ = false; });
    }
}

}  // namespace tessera
