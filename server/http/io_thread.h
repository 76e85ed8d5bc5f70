#pragma once

#include <chrono>
#include <exception>
#include <memory>
#include <thread>

#include <boost/asio/basic_waitable_timer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <spdlog/spdlog.h>

#include "server/http/session.h"

namespace tessera {

/// One thread with its own io_context: faster than a shared one with strands, and without locks.
struct IoThread {
    static constexpr std::chrono::milliseconds deadline_step{100};

    SessionContext context;  ///< Sessions that are cut off end with `io`, and need it until then.
    boost::asio::io_context io{1};
    boost::asio::executor_work_guard<IoExecutor> work{io.get_executor()};
    std::thread thread;

    explicit IoThread(SessionContext given) : context{std::move(given)} {
        context.streams->attach(io.get_executor());
    }
    ~IoThread() { context.streams->detach(); }
    IoThread(const IoThread&) = delete;
    IoThread& operator=(const IoThread&) = delete;

    void start() {
        boost::asio::co_spawn(io, check_deadlines(), boost::asio::detached);
        thread = std::thread{[this] { run(); }};
    }

    /// On this thread only.
    void serve(PageSocket socket) {
        boost::asio::co_spawn(io, Session::run(std::make_shared<Session>(std::move(socket), context)),
                              [](const std::exception_ptr& failure) {
                                  try {
                                      if (failure) std::rethrow_exception(failure);
                                  } catch (const std::exception& problem) {
                                      spdlog::error("a session ended with: {}", problem.what());
                                  }
                              });
    }

  private:
    void run() {
        for (;;) {
            try {
                io.run();
                return;
            } catch (const std::exception& unexpected) {
                spdlog::error("an I/O thread goes on after: {}", unexpected.what());
            }
        }
    }

    /// One timer for all sessions of the thread, in place of one for each operation.
    Task<void> check_deadlines() {
        boost::asio::basic_waitable_timer<std::chrono::steady_clock,
                                          boost::asio::wait_traits<std::chrono::steady_clock>, IoExecutor>
            timer{io.get_executor()};
        for (;;) {
            timer.expires_after(deadline_step);
            co_await timer.async_wait(boost::asio::use_awaitable_t<IoExecutor>{});
            const auto now = Session::Clock::now();
            for (Session* session : context.sessions) session->check_deadline(now);
            context.streams->check_deadlines(now);
        }
    }
};

}  // namespace tessera
