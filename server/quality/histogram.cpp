#include "server/quality/histogram.h"

#include <cmath>

namespace tessera {

double Histogram::percentile(double share) const noexcept {
    const double wanted = share * double(count_);
    double below = 0;
    for (std::size_t bin = 0; bin < counts_.size(); ++bin) {
        const double here = double(counts_[bin]);
        if (here > 0 && below + here >= wanted)
            return double(lowest_) + (double(bin) + (wanted - below) / here) / double(bins_per_unit);
        below += here;
    }
    return double(lowest_);
}

double distance(const Histogram& a, const Histogram& b) noexcept {
    if (a.count() == 0 || b.count() == 0) return 0;
    // What has to pass each border between bins is the difference of what lies below it
    double moved = 0, ahead = 0;
    for (std::size_t bin = 0; bin < std::min(a.counts().size(), b.counts().size()); ++bin) {
        ahead += double(a.counts()[bin]) / double(a.count()) - double(b.counts()[bin]) / double(b.count());
        moved += std::abs(ahead);
    }
    return moved / double(Histogram::bins_per_unit);
}

}  // namespace tessera
