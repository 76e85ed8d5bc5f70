#pragma once

#include <atomic>
#include <condition_variable>
#include <csignal>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace tessera {

/// "Load again", said by one thread to another. Said twice before the other listens, it is one.
class ReloadRequest {
  public:
    void make();
    /// True when one was made since the last time; false when `stop` comes first.
    bool wait(const std::stop_token& stop);

  private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool made_ = false;
};

/// TERM, INT and HUP, blocked in this thread and in all that it starts, so that only sigwait() takes them. A
/// broken pipe is an error of write(). Call first of all, while there is one thread.
sigset_t block_signals();

/// Takes the signals on a thread of its own, so that nothing that loads or waits keeps them waiting.
class ToldBySignals {
  public:
    /// HUP makes a `reload` request; TERM or INT requests a stop of `stop` and calls `stopping`, once, and
    /// then no signal is taken any more. All outlive this object.
    ToldBySignals(const sigset_t& signals, ReloadRequest& reload, std::stop_source& stop,
                  std::function<void()> stopping);
    /// Ends the thread, without `stopping` if no signal asked for it.
    ~ToldBySignals();
    ToldBySignals(const ToldBySignals&) = delete;
    ToldBySignals& operator=(const ToldBySignals&) = delete;

  private:
    std::atomic<bool> ended_ = false;
    std::thread thread_;
};

}  // namespace tessera
