#pragma once

#include <boost/asio/basic_stream_socket.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

namespace tessera {

/// Everything of one I/O thread runs on one io_context, so that sessions and streams need no locks.
using IoExecutor = boost::asio::io_context::executor_type;
using PageSocket = boost::asio::basic_stream_socket<boost::asio::ip::tcp, IoExecutor>;

}  // namespace tessera
