#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include "server/filter/footprint_filter.h"

namespace tessera {

/// How a request for samples ended.
enum class SampleResult : std::uint8_t { answered, malformed, overloaded, cancelled, timed_out, failed };

/// What Prometheus learns of this room. All members may be called from any thread.
class SampleMetrics {
  public:
    /// `registry` outlives this.
    explicit SampleMetrics(prometheus::Registry& registry);

    void count(SampleResult result) noexcept { requests_[static_cast<std::size_t>(result)]->Increment(); }
    double requests(SampleResult result) const {
        return requests_[static_cast<std::size_t>(result)]->Value();
    }

    /// What one filter has done: footprints, texels read, time.
    void count(FilterKind kind, std::size_t samples, std::uint64_t texels,
               std::chrono::nanoseconds time) noexcept;
    double samples(FilterKind kind) const {
        return by_filter_[static_cast<std::size_t>(kind)].samples->Value();
    }

    prometheus::Histogram& request_seconds;
    prometheus::Gauge& waiting;
    prometheus::Gauge& page_bytes;
    prometheus::Gauge& samplers;

  private:
    struct ByFilter {
        prometheus::Counter* samples = nullptr;
        prometheus::Counter* texels = nullptr;
        prometheus::Counter* seconds = nullptr;
    };
    std::array<prometheus::Counter*, 6> requests_{};
    std::array<ByFilter, static_cast<std::size_t>(FilterKind::exact) + 1> by_filter_{};
};

}  // namespace tessera
