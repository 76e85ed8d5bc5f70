#include "client/load/progress_view.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>

#include "client/load/report_text.h"

namespace tessera {
namespace {

double seconds(std::chrono::nanoseconds duration) { return std::chrono::duration<double>(duration).count(); }

std::string fixed(double value, int decimals) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
    return text.data();
}

std::string phase(const LoadProgress& progress) {
    return progress.warming_up ? "warming up" : progress.draining ? "waiting for the last" : "measuring";
}

std::string rates(const LoadProgress& progress) {
    const double interval = std::max(seconds(progress.since_last), 1e-9);
    const auto pages = static_cast<double>(progress.pages_since_last) / interval;
    return fixed(pages, pages < 100 ? 1 : 0) + " pages/s, " +
           bytes_text(static_cast<double>(progress.bytes_since_last) / interval) + "/s";
}

std::string waiting(const LoadProgress& progress) {
    std::string text = count_text(progress.in_flight) + " in flight";
    if (progress.tally.open_loop) text += ", " + count_text(progress.backlog) + " behind the plan";
    return text;
}

}  // namespace

std::string progress_line(const LoadProgress& progress) {
    return fixed(seconds(progress.elapsed), 1) + " s of " + fixed(seconds(progress.total), 1) + " s, " +
           phase(progress) + ": " + rates(progress) + ", p50 " +
           duration_text(progress.recent.percentile(50)) + ", p99 " +
           duration_text(progress.recent.percentile(99)) + ", " + waiting(progress) + ", " +
           count_text(progress.errors_since_last) + " errors";
}

std::string progress_block(const LoadProgress& progress) {
    constexpr int width = 40;
    const double share =
        std::clamp(seconds(progress.elapsed) / std::max(seconds(progress.total), 1e-9), 0.0, 1.0);
    std::string bar;
    for (int i = 0; i < width; ++i) bar += i < static_cast<int>(share * width) ? "█" : "░";
    const LatencyHistogram& all = progress.tally.latency();
    return "  " + bar + "  " + fixed(seconds(progress.elapsed), 1) + " of " +
           fixed(seconds(progress.total), 1) + " s  " + phase(progress) + "\n  now   " + rates(progress) +
           "   p50 " + duration_text(progress.recent.percentile(50)) + "   p99 " +
           duration_text(progress.recent.percentile(99)) + "   max " + duration_text(progress.recent.max()) +
           "   " + waiting(progress) + "\n  all   " + count_text(progress.tally.ok) + " pages   p50 " +
           duration_text(all.percentile(50)) + "   p99 " + duration_text(all.percentile(99)) + "   max " +
           duration_text(all.max()) + "   " + count_text(progress.tally.errors()) + " errors\n";
}

void ProgressView::show(const LoadProgress& progress) {
    if (!is_terminal_) {
        std::cerr << progress_line(progress) << "\n";
        return;
    }
    const std::string block = progress_block(progress);
    clear();
    // Lines are cut, not wrapped, so that the block's height is known
    std::cerr << "\x1b[?7l" << block << "\x1b[?7h" << std::flush;
    lines_ = static_cast<int>(std::count(block.begin(), block.end(), '\n'));
}

void ProgressView::clear() {
    if (lines_ > 0) std::cerr << "\x1b[" << lines_ << "A\x1b[J" << std::flush;
    lines_ = 0;
}

}  // namespace tessera
