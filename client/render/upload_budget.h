#pragma once

#include <algorithm>
#include <cstddef>

namespace tessera {

/// How many pages a frame may bring to the GPU, so that bringing them takes at most so long: by what the last
/// ones took.
class UploadBudget {
  public:
    static constexpr double milliseconds_a_frame = 2;
    static constexpr std::size_t most_a_frame = 8;

    /// At least 1, so that pictures become sharp on any machine; at most most_a_frame.
    std::size_t pages() const {
        if (page_ms_ <= 0) return most_a_frame;
        const double fit = milliseconds_a_frame / page_ms_;
        return std::clamp(static_cast<std::size_t>(std::min(fit, 1e3)), std::size_t{1}, most_a_frame);
    }
    /// What so many pages took.
    void spent(std::size_t pages, double milliseconds) {
        if (pages == 0) return;
        const double each = milliseconds / static_cast<double>(pages);
        // A dearer one counts at once, half as much; a cheaper one by and by
        page_ms_ += (each - page_ms_) * (page_ms_ == 0 ? 1 : each > page_ms_ ? 0.5 : 0.125);
    }

  private:
    double page_ms_ = 0;  ///< 0: not known yet
};

}  // namespace tessera
