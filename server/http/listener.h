#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/basic_socket_acceptor.hpp>

#include "server/http/io_thread.h"
#include "shared/result/result.h"

namespace tessera {

/// Accepts connections on the first I/O thread and deals them to all in turn. One acceptor and not one a
/// thread: with SO_REUSEPORT a second server could take the same port unnoticed.
class Listener {
  public:
    /// `threads` and `metrics` outlive the listener's io_context. Error: io_failure.
    static Result<std::unique_ptr<Listener>> open(const ServerOptions& options,
                                                  std::vector<std::unique_ptr<IoThread>>& threads,
                                                  HttpMetrics& metrics);

    boost::asio::ip::tcp::endpoint endpoint() const;
    /// Call once, before or while the threads run.
    void start();
    /// On the first I/O thread.
    void close();

  private:
    using Acceptor = boost::asio::basic_socket_acceptor<boost::asio::ip::tcp, IoExecutor>;

    Listener(Acceptor acceptor, std::size_t max_connections, std::vector<std::unique_ptr<IoThread>>& threads,
             HttpMetrics& metrics);
    Task<void> accept_all();
    Task<void> turn_away(PageSocket socket);

    Acceptor acceptor_;
    std::vector<std::unique_ptr<IoThread>>& threads_;
    HttpMetrics& metrics_;
    const std::size_t max_connections_;
    std::atomic<std::size_t> turned_away_now_ = 0;  ///< Changed on every I/O thread.
};

}  // namespace tessera
