#include "server/stream/stream_thread.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "server/stream/stream_session.h"

namespace tessera {
namespace {

/// Those who want to be woken within so little time are woken together.
constexpr std::chrono::milliseconds nap{1};

}  // namespace

StreamThread::StreamThread(StreamService& service)
    : service_{service},
      catalog_{std::make_shared<const Catalog>()},
      access_{std::make_shared<const Access>()} {}

StreamThread::~StreamThread() = default;

void StreamThread::attach(IoExecutor executor) {
    executor_ = executor;
    timer_.emplace(executor);
}

void StreamThread::detach() { timer_.reset(); }

std::shared_ptr<void> StreamThread::admit() { return service_.admit(); }

void StreamThread::serve(PageSocket socket, const Upgrade& upgrade, StreamOpening opening) {
    std::make_shared<StreamSession>(std::move(socket), *this, std::move(opening))->begin(upgrade);
}

void StreamThread::publish(std::shared_ptr<const Catalog> catalog, std::shared_ptr<const Access> access) {
    catalog_ = std::move(catalog);
    access_ = std::move(access);
    for (StreamSession* session : sessions_) session->site_changed();
}

void StreamThread::check_deadlines(Clock::time_point now) {
    for (StreamSession* session : sessions_) session->check(now);
}

void StreamThread::drain() {
    for (StreamSession* session : sessions_) session->drain();
}

void StreamThread::abort() {
    for (StreamSession* session : sessions_) session->abort();
}

std::shared_ptr<Audience> StreamThread::audience(const std::shared_ptr<SceneHub>& hub) {
    std::shared_ptr<Audience>& audience = audiences_[hub];
    if (!audience) audience = hub->add_audience(*executor_);
    return audience;
}

void StreamThread::wake_at(Clock::time_point time, const std::shared_ptr<StreamSession>& session) {
    sleepers_.emplace(time, session);
    if (time < wakes_at_) wait();
}

void StreamThread::wait() {
    wakes_at_ = sleepers_.begin()->first;
    timer_->expires_at(std::max(wakes_at_, Clock::now() + nap));  // what waits already does so no more
    timer_->async_wait([this](const boost::system::error_code& failure) {
        if (failure) return;
        wakes_at_ = Clock::time_point::max();
        const auto now = Clock::now();
        std::vector<std::weak_ptr<StreamSession>> due;
        while (!sleepers_.empty() && sleepers_.begin()->first <= now) {
            due.push_back(std::move(sleepers_.begin()->second));
            sleepers_.erase(sleepers_.begin());
        }
        for (const auto& sleeper : due)
            if (const auto session = sleeper.lock()) session->woke();
        if (!sleepers_.empty() && sleepers_.begin()->first < wakes_at_) wait();
    });
}

}  // namespace tessera
