#include "server/http/listener.h"

#include <array>
#include <utility>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>

namespace tessera {
namespace {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;

constexpr auto as_tuple = asio::as_tuple(asio::use_awaitable_t<IoExecutor>{});
constexpr std::size_t most_turned_away_at_once = 64;
constexpr std::chrono::milliseconds accept_pause{100};
constexpr std::string_view busy_answer =
    "HTTP/1.1 503 Service Unavailable\r\n"
    "Content-Type: text/plain; charset=utf-8\r\n"
    "Content-Length: 22\r\n"
    "Cache-Control: no-store\r\n"
    "Retry-After: 1\r\n"
    "Connection: close\r\n"
    "\r\n"
    "too many connections\r\n";

using Timer = asio::basic_waitable_timer<std::chrono::steady_clock,
                                         asio::wait_traits<std::chrono::steady_clock>, IoExecutor>;

}  // namespace

Listener::Listener(Acceptor acceptor, std::size_t max_connections,
                   std::vector<std::unique_ptr<IoThread>>& threads, HttpMetrics& metrics)
    : acceptor_{std::move(acceptor)},
      threads_{threads},
      metrics_{metrics},
      max_connections_{max_connections} {}

Result<std::unique_ptr<Listener>> Listener::open(const ServerOptions& options,
                                                 std::vector<std::unique_ptr<IoThread>>& threads,
                                                 HttpMetrics& metrics) {
    const std::string where = options.address + ":" + std::to_string(options.port);
    boost::system::error_code failure;
    const auto address = asio::ip::make_address(options.address, failure);
    if (failure)
        return Error{ErrorCode::invalid_input,
                     "--listen " + where + ": the address is numeric, such as 127.0.0.1:7070 or [::1]:7070"};
    const tcp::endpoint endpoint{address, options.port};
    Acceptor acceptor{threads.front()->io.get_executor()};
    acceptor.open(endpoint.protocol(), failure);
    if (!failure) acceptor.set_option(asio::socket_base::reuse_address{true}, failure);
    if (!failure) acceptor.bind(endpoint, failure);
    if (!failure) acceptor.listen(4096, failure);
    if (failure)
        return Error{ErrorCode::io_failure,
                     "--listen " + where + ": " + failure.message() +
                         (failure == asio::error::address_in_use
                              ? "; stop the other server or choose another port, 0 for any"
                              : "")};
    return std::unique_ptr<Listener>{
        new Listener{std::move(acceptor), options.max_connections, threads, metrics}};
}

tcp::endpoint Listener::endpoint() const {
    boost::system::error_code ignored;
    return acceptor_.local_endpoint(ignored);
}

void Listener::start() { asio::co_spawn(acceptor_.get_executor(), accept_all(), asio::detached); }

void Listener::close() {
    boost::system::error_code ignored;
    acceptor_.close(ignored);
}

Task<void> Listener::accept_all() {
    Timer timer{acceptor_.get_executor()};
    bool paused = false;
    for (std::size_t next = 0;;) {
        IoThread& thread = *threads_[next];
        auto [failure, socket] = co_await acceptor_.async_accept(thread.io.get_executor(), as_tuple);
        if (!acceptor_.is_open()) co_return;
        if (failure) {
            // A connection that is gone already costs nothing; no descriptors left does not mend itself at
            // once
            if (failure == asio::error::connection_aborted || failure == asio::error::interrupted) continue;
            if (!std::exchange(paused, true))
                spdlog::warn("cannot accept connections: {}; trying again every {} ms", failure.message(),
                             accept_pause.count());
            timer.expires_after(accept_pause);
            co_await timer.async_wait(as_tuple);
            continue;
        }
        paused = false;
        if (static_cast<std::size_t>(metrics_.connections.Value()) >= max_connections_) {
            metrics_.connections_refused.Increment();
            // Counted here and not by the coroutine, which begins later: a crowd would pass the limit
            // meanwhile
            if (turned_away_now_ < most_turned_away_at_once) {
                ++turned_away_now_;
                asio::co_spawn(thread.io.get_executor(), turn_away(std::move(socket)), asio::detached);
            }
            continue;
        }
        metrics_.connections.Increment();
        asio::post(thread.io,
                   [&thread, accepted = std::move(socket)]() mutable { thread.serve(std::move(accepted)); });
        next = (next + 1) % threads_.size();
    }
}

Task<void> Listener::turn_away(PageSocket socket) {
    boost::system::error_code failure;
    socket.non_blocking(true, failure);
    socket.write_some(asio::buffer(busy_answer), failure);
    socket.shutdown(tcp::socket::shutdown_send, failure);
    // Closed at once, with the request unread, the answer would be lost to a reset
    Timer timer{socket.get_executor(), accept_pause};
    co_await timer.async_wait(as_tuple);
    std::array<char, 4096> block;
    while (!failure && socket.read_some(asio::buffer(block), failure) > 0) {
    }
    --turned_away_now_;
}

}  // namespace tessera
