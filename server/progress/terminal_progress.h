#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "server/progress/progress.h"

namespace tessera {

/// "[####..........................]  14 %  tile, 1 min 5 s left": `whole` of everything is done, 0 to 1.
std::string progress_line(const std::string& stage, double whole, double seconds_passed);

/// Shows progress on stderr: on a terminal one line, drawn again and again; elsewhere a line for each stage.
class TerminalProgress final : public Progress {
  public:
    /// A stage and its part of the whole time; the parts sum to 1.
    struct Share {
        std::string stage;
        double part = 0;
    };

    /// `command`: who speaks, such as "tessera prepare". `shares` in the order of the stages; others count
    /// for nothing. `quiet` shows
    /// nothing, not even notes.
    TerminalProgress(std::string command, std::vector<Share> shares, bool quiet, std::stop_token stop);
    ~TerminalProgress() override;

    void advance(std::string_view stage, double fraction) override;
    void note(const std::string& sentence) override;
    std::stop_token stop() const override { return stop_; }

  private:
    using Clock = std::chrono::steady_clock;
    void draw(Clock::time_point now);
    void wipe();

    std::mutex mutex_;
    const std::string command_;
    const std::vector<Share> shares_;
    const bool quiet_;
    const bool terminal_;
    const std::stop_token stop_;
    const Clock::time_point begin_ = Clock::now();
    Clock::time_point drawn_at_{};
    bool drawn_ = false;
    std::string stage_;
    double whole_ = 0;  ///< Of everything, 0 to 1; never goes back.
};

}  // namespace tessera
