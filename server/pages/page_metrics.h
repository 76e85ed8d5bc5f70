#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string_view>

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include "shared/page/channel_set.h"
#include "shared/page/page_key.h"

namespace tessera {

/// How a request for a page ended.
enum class PageResult : std::uint8_t {
    cached,      ///< Found in the cache.
    coalesced,   ///< Joined an evaluation that was under way or queued.
    evaluated,   ///< Started an evaluation.
    overloaded,  ///< Turned away, or pushed out of the queue by something more urgent.
    cancelled,   ///< The asker left before the page was done.
    timed_out,   ///< The deadline passed first.
    failed,      ///< The evaluation or a codec failed.
};

/// What Prometheus learns of this room. All members may be called from any thread.
class PageMetrics {
  public:
    /// `registry` outlives this.
    explicit PageMetrics(prometheus::Registry& registry);

    void count(PageResult result, std::uint8_t level) noexcept {
        requests_[static_cast<std::size_t>(result)][level]->Increment();
    }
    void count(ChannelSet set) noexcept { by_channels_[static_cast<std::size_t>(set)]->Increment(); }
    double requests(PageResult result) const;  ///< Over all levels.

    prometheus::Counter& evaluations;            ///< Begun.
    prometheus::Counter& evaluations_abandoned;  ///< Dropped from the queue or stopped: nobody waited.
    prometheus::Histogram& queue_seconds;
    prometheus::Histogram& evaluate_seconds;
    prometheus::Histogram& encode_seconds;
    prometheus::Gauge& queued;
    prometheus::Gauge& running;
    prometheus::Gauge& cache_bytes;
    prometheus::Gauge& cache_pages;
    prometheus::Gauge& cache_evictions;

  private:
    static constexpr std::size_t results = 7;
    std::array<std::array<prometheus::Counter*, max_level + 1>, results> requests_{};
    std::array<prometheus::Counter*, channel_sets.size()> by_channels_{};
};

}  // namespace tessera
