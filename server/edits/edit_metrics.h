#pragma once

#include <array>
#include <chrono>
#include <map>
#include <string>

#include <prometheus/counter.h>
#include <prometheus/family.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include "server/edits/live_scene.h"

namespace tessera {

/// What Prometheus learns of edits. All members may be called from any thread, update() by one at a time.
class EditMetrics {
  public:
    /// `registry` outlives this.
    explicit EditMetrics(prometheus::Registry& registry);

    /// How an edit ended that arrived `time` ago.
    void count(const EditOutcome& outcome, std::chrono::nanoseconds time) noexcept;

    /// Sets the gauges of a scene.
    void update(const std::string& scene, const JournalStatus& journal, std::size_t sprites);

  private:
    /// Of one scene.
    struct Gauges {
        prometheus::Gauge& revision;
        prometheus::Gauge& remembered;
        prometheus::Gauge& since_snapshot;
        prometheus::Gauge& bytes;
        prometheus::Gauge& trouble;
        prometheus::Gauge& sprites;
    };

    static constexpr std::size_t reasons = 7;
    prometheus::Counter& accepted_;
    prometheus::Counter& again_;
    std::array<prometheus::Counter*, reasons> refused_{};
    prometheus::Histogram& seconds_;

    using GaugeFamily = prometheus::Family<prometheus::Gauge>;
    GaugeFamily &revision_, &remembered_, &since_snapshot_, &bytes_, &trouble_, &sprites_;
    std::map<std::string, Gauges> scenes_;
};

}  // namespace tessera
