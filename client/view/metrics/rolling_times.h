#pragma once

#include <cstddef>
#include <vector>

namespace tessera {

/// The last some times, in milliseconds, and what share of them stays below which.
class RollingTimes {
  public:
    /// Remembers the last `most`, at least 1.
    explicit RollingTimes(std::size_t most) : most_{most} { times_.reserve(most); }

    void add(double milliseconds);
    std::size_t size() const { return times_.size(); }
    double last() const { return times_.empty() ? 0 : times_[(next_ + times_.size() - 1) % times_.size()]; }
    double worst() const;
    /// The time that this share (0 to 1) of all does not exceed: of the sorted times the one of rank
    /// ⌈share · count⌉. 0 while there are none.
    double percentile(double share) const;

  private:
    std::size_t most_;
    std::vector<double> times_;
    std::size_t next_ = 0;  ///< The oldest, once all places are taken
};

}  // namespace tessera
