#include "client/link/background_page_client.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

namespace tessera {

namespace asio = boost::asio;

class BackgroundPageClient::Worker {
  public:
    Worker(ServerAddress server, SceneInfo scene, PageClientSettings settings, std::size_t max_outstanding)
        : max_outstanding_{max_outstanding},
          work_{context_.get_executor()},
          client_{std::make_unique<PageClient>(context_.get_executor(), std::move(server), std::move(scene),
                                               settings)},
          thread_{[this] { context_.run(); }} {}

    ~Worker() {
        asio::post(context_, [this] {
            client_.reset();
            work_.reset();
        });
        thread_.join();  // closed sockets end their operations with an error at once
    }

    std::optional<RequestId> request(PageKey page, const FetchOptions& options) {
        RequestId id = 0;
        {
            const std::lock_guard lock{mutex_};
            if (outstanding_ >= max_outstanding_) return std::nullopt;
            ++outstanding_;
            id = ++last_id_;
        }
        asio::post(context_, [this, id, page, options] { start(id, page, options); });
        return id;
    }

    void cancel(RequestId id) {
        asio::post(context_, [this, id] {
            const auto found = inner_ids_.find(id);
            if (found != inner_ids_.end()) client_->cancel(found->second);
        });
    }

    void cancel_all() {
        asio::post(context_, [this] { client_->cancel_all(); });
    }

    std::vector<FinishedPage> take_finished(std::size_t most) {
        std::vector<FinishedPage> taken;
        const std::lock_guard lock{mutex_};
        const std::size_t count = std::min(most, finished_.size());
        taken.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            taken.push_back(std::move(finished_.front()));
            finished_.pop_front();
        }
        outstanding_ -= count;
        return taken;
    }

    bool wait_for_finished(std::chrono::milliseconds timeout) {
        std::unique_lock lock{mutex_};
        return arrived_.wait_for(lock, timeout, [&] { return !finished_.empty(); });
    }

    std::size_t outstanding() const {
        const std::lock_guard lock{mutex_};
        return outstanding_;
    }

    PageClientStatistics statistics() const {
        const std::lock_guard lock{mutex_};
        return statistics_;
    }

  private:
    // On the worker's thread
    void start(RequestId id, PageKey page, const FetchOptions& options) {
        const RequestId inner =
            client_->get(page, options, [this, id, page, options](RequestId, Result<PageReply> result) {
                inner_ids_.erase(id);
                const PageClientStatistics now = client_ ? client_->statistics() : PageClientStatistics{};
                {
                    const std::lock_guard lock{mutex_};
                    finished_.push_back({id, page, options, std::move(result)});
                    statistics_ = now;
                }
                arrived_.notify_all();
            });
        inner_ids_.emplace(id, inner);
    }

    const std::size_t max_outstanding_;
    asio::io_context context_{1};
    asio::executor_work_guard<asio::io_context::executor_type> work_;
    std::unique_ptr<PageClient> client_;                  // of the worker's thread alone
    std::unordered_map<RequestId, RequestId> inner_ids_;  // of the worker's thread alone

    mutable std::mutex mutex_;
    std::condition_variable arrived_;
    std::deque<FinishedPage> finished_;
    std::size_t outstanding_ = 0;
    RequestId last_id_ = 0;
    PageClientStatistics statistics_;

    std::thread thread_;  // last: it starts when all else is there
};

BackgroundPageClient::BackgroundPageClient(ServerAddress server, SceneInfo scene, PageClientSettings settings,
                                           std::size_t max_outstanding)
    : worker_{std::make_unique<Worker>(std::move(server), std::move(scene), settings, max_outstanding)} {}
BackgroundPageClient::~BackgroundPageClient() = default;

std::optional<RequestId> BackgroundPageClient::request(PageKey page, const FetchOptions& options) {
    return worker_->request(page, options);
}
void BackgroundPageClient::cancel(RequestId id) { worker_->cancel(id); }
void BackgroundPageClient::cancel_all() { worker_->cancel_all(); }
std::vector<FinishedPage> BackgroundPageClient::take_finished(std::size_t most) {
    return worker_->take_finished(most);
}
bool BackgroundPageClient::wait_for_finished(std::chrono::milliseconds timeout) {
    return worker_->wait_for_finished(timeout);
}
std::size_t BackgroundPageClient::outstanding() const { return worker_->outstanding(); }
PageClientStatistics BackgroundPageClient::statistics() const { return worker_->statistics(); }

}  // namespace tessera
