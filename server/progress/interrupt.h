#pragma once

#include <csignal>
#include <stop_token>
#include <thread>

namespace tessera {

/// While it lives, Ctrl-C and SIGTERM ask to stop instead of ending the program. Made before any other
/// thread, so that all threads inherit the blocked signals.
class Interrupt {
  public:
    Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;
    ~Interrupt();

    std::stop_token token() const { return source_.get_token(); }

    /// The signal that came to any of them so far; 0: none. A program that was told to stop and could not
    /// finish ends with 128 and this.
    static int signal_that_came() noexcept;

  private:
    sigset_t before_{};
    std::stop_source source_;
    std::jthread watcher_;
};

}  // namespace tessera
