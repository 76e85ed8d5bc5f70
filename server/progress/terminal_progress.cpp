#include "server/progress/terminal_progress.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <unistd.h>

namespace tessera {

TerminalProgress::TerminalProgress(std::string command, std::vector<Share> shares, bool quiet,
                                   std::stop_token stop)
    : command_{std::move(command)},
      shares_{std::move(shares)},
      quiet_{quiet},
      terminal_{::isatty(STDERR_FILENO) == 1},
      stop_{std::move(stop)} {}

TerminalProgress::~TerminalProgress() { wipe(); }

void TerminalProgress::advance(std::string_view stage, double fraction) {
    if (quiet_) return;
    const std::lock_guard lock{mutex_};
    double before = 0, part = 0;
    for (const Share& share : shares_) {
        part = share.part;
        if (share.stage == stage) break;
        before += share.part;
    }
    const bool next_stage = stage_ != stage;
    stage_ = stage;
    whole_ = std::max(whole_, before + part * std::clamp(fraction, 0.0, 1.0));
    const auto now = Clock::now();
    if (!terminal_) {
        if (next_stage) std::fprintf(stderr, "%s: %s\n", command_.c_str(), stage_.c_str());
    } else if (next_stage || now - drawn_at_ > std::chrono::milliseconds{100}) {
        draw(now);
    }
}

void TerminalProgress::note(const std::string& sentence) {
    if (quiet_) return;
    const std::lock_guard lock{mutex_};
    wipe();
    std::fprintf(stderr, "%s: %s\n", command_.c_str(), sentence.c_str());
}

void TerminalProgress::draw(Clock::time_point now) {
    constexpr int bar_length = 30;
    const int full = static_cast<int>(whole_ * bar_length);
    std::string bar(static_cast<std::size_t>(full), '#');
    bar.resize(bar_length, '.');
    const double passed = std::chrono::duration<double>(now - begin_).count();
    std::string remaining;
    if (whole_ > 0.03)
        remaining = ", " + std::to_string(static_cast<int>(passed / whole_ - passed) + 1) + " s left";
    std::fprintf(stderr, "\r\033[K[%s] %3d %%  %s%s", bar.c_str(), static_cast<int>(whole_ * 100),
                 stage_.c_str(), remaining.c_str());
    std::fflush(stderr);
    drawn_at_ = now;
    drawn_ = true;
}

void TerminalProgress::wipe() {
    if (!drawn_) return;
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
    drawn_ = false;
}

}  // namespace tessera
