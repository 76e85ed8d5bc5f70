#pragma once

#include <chrono>
#include <utility>

#include <boost/beast/core/role.hpp>
#include <boost/beast/websocket/teardown.hpp>

#include "server/stream/page_socket.h"

namespace tessera {

/// A socket that knows when something was written last: a long message to a slow reader is no dead
/// connection as long as parts of it leave.
class WatchedSocket : public PageSocket {
  public:
    using Clock = std::chrono::steady_clock;

    explicit WatchedSocket(PageSocket socket) : PageSocket{std::move(socket)} {}

    /// Of a message this is called once for each part that the socket takes.
    template <class Buffers, class Token>
    auto async_write_some(const Buffers& buffers, Token&& token) {
        last_write = Clock::now();
        return PageSocket::async_write_some(buffers, std::forward<Token>(token));
    }

    Clock::time_point last_write{};
};

// Beast asks for these by the stream's own type
inline void teardown(boost::beast::role_type role, WatchedSocket& socket,
                     boost::system::error_code& failure) {
    boost::beast::websocket::teardown(role, static_cast<PageSocket&>(socket), failure);
}
template <class Handler>
void async_teardown(boost::beast::role_type role, WatchedSocket& socket, Handler&& handler) {
    boost::beast::websocket::async_teardown(role, static_cast<PageSocket&>(socket),
                                            std::forward<Handler>(handler));
}

}  // namespace tessera
