#include "server/progress/terminal_progress.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <utility>

#include <unistd.h>

namespace tessera {

std::string progress_line(const std::string& stage, double whole, double seconds_passed) {
    constexpr int bar_length = 30;
    std::string line = "[";
    for (int i = 0; i < bar_length; ++i) line += i < static_cast<int>(whole * bar_length) ? '#' : '.';
    const std::string percent = std::to_string(static_cast<int>(whole * 100));
    line += "] " + std::string(3 - std::min<std::size_t>(3, percent.size()), ' ') + percent + " %  " + stage;
    // Earlier it would be a guess
    if (whole <= 0.03) return line;
    const auto left = static_cast<std::int64_t>(seconds_passed / whole - seconds_passed) + 1;
    line += ", ";
    if (left >= 60) line += std::to_string(left / 60) + " min ";
    return line + std::to_string(left % 60) + " s left";
}

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
    double before = 0;
    for (const Share& share : shares_) {
        if (share.stage == stage) {
            whole_ = std::max(whole_, before + share.part * std::clamp(fraction, 0.0, 1.0));
            break;
        }
        before += share.part;
    }
    const bool next_stage = stage_ != stage;
    stage_ = stage;
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
    const double passed = std::chrono::duration<double>(now - begin_).count();
    std::fprintf(stderr, "\r\033[K%s", progress_line(stage_, whole_, passed).c_str());
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
