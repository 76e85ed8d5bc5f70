#include "server/http/told_by_signals.h"

#include <utility>

#include <pthread.h>

namespace tessera {

void ReloadRequest::make() {
    {
        const std::lock_guard lock{mutex_};
        made_ = true;
    }
    changed_.notify_one();
}

bool ReloadRequest::wait(const std::stop_token& stop) {
    std::unique_lock lock{mutex_};
    changed_.wait(lock, stop, [this] { return made_; });
    return !stop.stop_requested() && std::exchange(made_, false);
}

sigset_t block_signals() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
    return signals;
}

ToldBySignals::ToldBySignals(const sigset_t& signals, ReloadRequest& reload, std::stop_source& stop,
                             std::function<void()> stopping)
    : thread_{[this, signals, &reload, &stop, stopping = std::move(stopping)] {
          for (int signal = 0; sigwait(&signals, &signal) == 0 && signal == SIGHUP;) reload.make();
          if (ended_) return;
          stop.request_stop();
          stopping();
      }} {}

ToldBySignals::~ToldBySignals() {
    ended_ = true;
    pthread_kill(thread_.native_handle(), SIGTERM);  // wakes sigwait(); blocked everywhere else
    thread_.join();
}

}  // namespace tessera
