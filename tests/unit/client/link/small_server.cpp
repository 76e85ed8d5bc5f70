#include "tests/unit/client/link/small_server.h"

#include <array>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>

namespace tessera::test {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;

namespace {
constexpr auto as_result = asio::as_tuple(asio::use_awaitable);
}

SmallServer::SmallServer(Handler handler)
    : handler_{std::move(handler)},
      acceptor_{context_, {asio::ip::address_v4::loopback(), 0}},
      port_{acceptor_.local_endpoint().port()} {
    asio::co_spawn(context_, accept(), asio::detached);
    thread_ = std::thread{[this] { context_.run(); }};
}

SmallServer::~SmallServer() {
    context_.stop();
    thread_.join();
}

std::vector<std::string> SmallServer::targets() const {
    const std::lock_guard lock{mutex_};
    return targets_;
}

void SmallServer::freeze(std::chrono::milliseconds frozen, std::chrono::milliseconds period) {
    const std::lock_guard lock{mutex_};
    freezing_since_ = std::chrono::steady_clock::now();
    frozen_ = frozen;
    period_ = period;
}

asio::awaitable<void> SmallServer::accept() {
    for (;;) {
        auto [error, socket] = co_await acceptor_.async_accept(as_result);
        if (error) co_return;
        ++connections_;
        asio::co_spawn(context_, serve(std::move(socket)), asio::detached);
    }
}

asio::awaitable<void> SmallServer::serve(tcp::socket socket) {
    boost::beast::flat_buffer buffer;
    asio::steady_timer timer{context_};
    socket.set_option(tcp::no_delay{true});
    for (;;) {
        Request request;
        const auto [read_error, read] = co_await http::async_read(socket, buffer, request, as_result);
        if (read_error) co_return;
        auto until = std::chrono::steady_clock::time_point{};
        {
            const std::lock_guard lock{mutex_};
            targets_.emplace_back(request.target().data(), request.target().size());
            const auto since = std::chrono::steady_clock::now() - freezing_since_;
            if (frozen_.count() > 0 && since % period_ < frozen_)
                until = freezing_since_ + since - since % period_ + frozen_;
        }
        const Answer answer = handler_(request);
        if (answer.delay.count() > 0) until = std::chrono::steady_clock::now() + answer.delay;
        if (until > std::chrono::steady_clock::now()) {
            timer.expires_at(until);
            co_await timer.async_wait(as_result);
            // A client that left meanwhile has sent the end of its stream
            boost::system::error_code state;
            std::array<char, 1> byte{};
            socket.non_blocking(true);
            const std::size_t got = socket.receive(asio::buffer(byte), tcp::socket::message_peek, state);
            if ((!state && got == 0) || (state && state != asio::error::would_block)) {
                ++hung_up_early_;
                co_return;
            }
        }
        if (!answer.raw.empty()) {
            co_await asio::async_write(socket, asio::buffer(answer.raw), as_result);
            co_return;
        }
        http::response<http::string_body> response{static_cast<http::status>(answer.status), 11, answer.body};
        for (const auto& [name, value] : answer.fields) response.set(name, value);
        response.prepare_payload();
        const auto [write_error, written] = co_await http::async_write(socket, response, as_result);
        if (write_error || answer.close_after) co_return;
    }
}

std::string small_tile_json(unsigned n) {
    return R"({"tilejson": "3.0.0", "name": "A checker", "tiles": [], "maxzoom": )" + std::to_string(n) +
           R"(, "from_a_newer_server": true, "tessera": {"id": "checker", "extent_log2_pages": )" +
           std::to_string(n) +
           R"(, "page_side": 256, "max_gutter": 8, "revision": "7", "fingerprint": "abc", "formats": ["png", "rgba"],
             "texture": "checker"}})";
}

}  // namespace tessera::test
