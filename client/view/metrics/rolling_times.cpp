#include "client/view/metrics/rolling_times.h"

#include <algorithm>
#include <cmath>

namespace tessera {

void RollingTimes::add(double milliseconds) {
    if (times_.size() < most_) {
        times_.push_back(milliseconds);
        return;
    }
    times_[next_] = milliseconds;
    next_ = (next_ + 1) % most_;
}

double RollingTimes::worst() const { return times_.empty() ? 0 : std::ranges::max(times_); }

double RollingTimes::percentile(double share) const {
    if (times_.empty()) return 0;
    std::vector<double> sorted = times_;
    const double rank = std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(sorted.size()));
    const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
    std::ranges::nth_element(sorted, at);
    return *at;
}

}  // namespace tessera
