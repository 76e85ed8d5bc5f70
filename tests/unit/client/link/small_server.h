#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "client/link/server_address.h"

namespace tessera::test {

/// A server for tests, on 127.0.0.1 and a port of its own, that answers what the test tells it to.
class SmallServer {
  public:
    using Request = boost::beast::http::request<boost::beast::http::string_body>;
    struct Answer {
        unsigned status = 200;
        std::string body{};
        std::vector<std::pair<std::string, std::string>> fields{};
        std::chrono::milliseconds delay{0};  ///< Before the answer is sent.
        bool close_after = false;            ///< Close the connection without having said so.
        std::string raw{};  ///< If not empty, these bytes are sent instead, and the connection closed.
    };
    using Handler = std::function<Answer(const Request&)>;

    explicit SmallServer(Handler handler);  ///< `handler` runs on the server's thread.
    ~SmallServer();

    ServerAddress address() const { return {"127.0.0.1", port_}; }
    int connections() const { return connections_; }      ///< Accepted so far.
    int hung_up_early() const { return hung_up_early_; }  ///< Clients that left before their answer was sent.
    std::vector<std::string> targets() const;             ///< Of all requests so far.

    /// From now on every answer waits until the frozen time is over: `frozen` of every `period`, from the
    /// start on.
    void freeze(std::chrono::milliseconds frozen, std::chrono::milliseconds period);

  private:
    boost::asio::awaitable<void> accept();
    boost::asio::awaitable<void> serve(boost::asio::ip::tcp::socket socket);

    Handler handler_;
    boost::asio::io_context context_{1};
    boost::asio::ip::tcp::acceptor acceptor_;
    std::uint16_t port_ = 0;
    std::atomic<int> connections_ = 0;
    std::atomic<int> hung_up_early_ = 0;
    mutable std::mutex mutex_;
    std::vector<std::string> targets_;
    std::chrono::steady_clock::time_point freezing_since_{};
    std::chrono::milliseconds frozen_{0};
    std::chrono::milliseconds period_{1};
    std::thread thread_;
};

/// TileJSON of a scene named "checker", whose extent is 256·2^n texels a side.
std::string small_tile_json(unsigned n);

}  // namespace tessera::test
