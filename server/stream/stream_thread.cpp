#include "server/stream/stream_thread.h"

#include <utility>

#include "server/stream/stream_session.h"

namespace tessera {
namespace {

constexpr std::chrono::milliseconds nap{4};

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

void StreamThread::wake_soon(const std::shared_ptr<StreamSession>& session) {
    sleepers_.push_back(session);
    if (!std::exchange(waiting_, true)) wait();
}

void StreamThread::wait() {
    timer_->expires_after(nap);
    timer_->async_wait([this](const boost::system::error_code& failure) {
        waiting_ = false;
        if (failure) return;
        for (const auto& sleeper : std::exchange(sleepers_, {}))
            if (const auto session = sleeper.lock()) session->woke();
    });
}

}  // namespace tessera
