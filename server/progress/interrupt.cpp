#include "server/progress/interrupt.h"

#include <atomic>
#include <ctime>

namespace tessera {
namespace {

std::atomic<int> came{0};

}  // namespace

int Interrupt::signal_that_came() noexcept { return came; }

Interrupt::Interrupt() {
    sigset_t stopping;
    sigemptyset(&stopping);
    sigaddset(&stopping, SIGINT);
    sigaddset(&stopping, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &stopping, &before_);
    watcher_ = std::jthread{[this, stopping](const std::stop_token& over) {
        const timespec moment{0, 50'000'000};
        while (!over.stop_requested() && !source_.stop_requested())
            if (const int signal = sigtimedwait(&stopping, nullptr, &moment); signal > 0) {
                came = signal;
                source_.request_stop();
            }
    }};
}

Interrupt::~Interrupt() {
    watcher_.request_stop();
    watcher_.join();
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace tessera
