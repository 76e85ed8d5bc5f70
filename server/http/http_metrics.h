#pragma once

#include <array>
#include <cstddef>

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/registry.h>

namespace tessera {

/// What Prometheus learns of the listener. All members may be called from any thread.
class HttpMetrics {
  public:
    /// `registry` outlives this.
    explicit HttpMetrics(prometheus::Registry& registry);

    void count_answer(unsigned status, std::size_t bytes) noexcept {
        answers_[status < answers_.size() && answers_[status] != nullptr ? status : 500]->Increment();
        bytes_.Increment(static_cast<double>(bytes));
    }
    double answers(unsigned status) const { return answers_[status]->Value(); }

    prometheus::Gauge& connections;
    prometheus::Counter& connections_refused;
    prometheus::Counter& reloads_failed;
    prometheus::Gauge& scenes;
    prometheus::Gauge& scenes_broken;

  private:
    prometheus::Counter& bytes_;
    std::array<prometheus::Counter*, 512> answers_{};
};

}  // namespace tessera
