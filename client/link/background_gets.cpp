#include "client/link/background_gets.h"

#include <algorithm>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

namespace tessera {

namespace asio = boost::asio;

namespace {
constexpr std::size_t most_out = 64;
}

class BackgroundGets::Worker {
  public:
    Worker(ServerAddress server, HttpLimits limits)
        : connection_{context_.get_executor(), std::move(server), limits}, work_{context_.get_executor()} {
        thread_ = std::thread{[this] { context_.run(); }};
    }
    ~Worker() {
        asio::post(context_, [this] {
            closing_ = true;
            connection_.close();
            work_.reset();
        });
        thread_.join();
    }

    bool ask(std::string target) {
        {
            const std::lock_guard lock{mutex_};
            if (out_ == most_out) return false;
            ++out_;
        }
        asio::post(context_, [this, target = std::move(target)]() mutable {
            waiting_.push_back(std::move(target));
            if (!is_running_) asio::co_spawn(context_, run(), asio::detached);
        });
        return true;
    }

    std::vector<Got> take(std::size_t most) {
        const std::lock_guard lock{mutex_};
        std::vector<Got> taken;
        for (; taken.size() < most && !got_.empty(); got_.pop_front())
            taken.push_back(std::move(got_.front()));
        out_ -= taken.size();
        return taken;
    }

  private:
    asio::awaitable<void> run() {
        is_running_ = true;
        while (!waiting_.empty() && !closing_) {
            std::string target = std::move(waiting_.front());
            waiting_.pop_front();
            auto reply = co_await connection_.get(target);
            const std::lock_guard lock{mutex_};
            got_.push_back({std::move(target), std::move(reply)});
        }
        is_running_ = false;
    }

    asio::io_context context_;
    HttpConnection connection_;
    asio::executor_work_guard<asio::io_context::executor_type> work_;
    std::deque<std::string> waiting_;  // on the thread, as the next two
    bool is_running_ = false, closing_ = false;
    std::mutex mutex_;  // guards what follows
    std::deque<Got> got_;
    std::size_t out_ = 0;
    std::thread thread_;
};

BackgroundGets::BackgroundGets(ServerAddress server, HttpLimits limits)
    : worker_{std::make_unique<Worker>(std::move(server), limits)} {}
BackgroundGets::~BackgroundGets() = default;
bool BackgroundGets::ask(std::string target) { return worker_->ask(std::move(target)); }
std::vector<BackgroundGets::Got> BackgroundGets::take(std::size_t most) { return worker_->take(most); }

}  // namespace tessera
