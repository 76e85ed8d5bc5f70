#include "server/pages/page_metrics.h"

#include <string>

namespace tessera {
namespace {

constexpr std::array<const char*, 7> result_names{"cached",    "coalesced", "evaluated", "overloaded",
                                                  "cancelled", "timed_out", "failed"};

prometheus::Gauge& gauge(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({});
}

prometheus::Counter& counter(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry).Add({});
}

prometheus::Histogram& seconds(prometheus::Registry& registry, const char* name, const char* help) {
    const prometheus::Histogram::BucketBoundaries bounds{
        0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10};
    return prometheus::BuildHistogram().Name(name).Help(help).Register(registry).Add({}, bounds);
}

}  // namespace

PageMetrics::PageMetrics(prometheus::Registry& registry)
    : evaluations{counter(registry, "tessera_evaluations_total", "Page evaluations begun")},
      evaluations_abandoned{counter(registry, "tessera_evaluations_abandoned_total",
                                    "Evaluations dropped or stopped because nobody waited any more")},
      queue_seconds{
          seconds(registry, "tessera_page_queue_seconds", "Time a page waited for an evaluation thread")},
      evaluate_seconds{seconds(registry, "tessera_page_evaluate_seconds", "Time to evaluate a page")},
      encode_seconds{seconds(registry, "tessera_page_encode_seconds", "Time to encode a page")},
      queued{gauge(registry, "tessera_evaluations_queued", "Pages that wait for an evaluation thread")},
      running{gauge(registry, "tessera_evaluations_running", "Pages being evaluated")},
      cache_bytes{gauge(registry, "tessera_page_cache_bytes", "Bytes held by the page cache")},
      cache_pages{gauge(registry, "tessera_page_cache_pages", "Pages held by the page cache")},
      cache_evictions{
          gauge(registry, "tessera_page_cache_evictions", "Pages pushed out of the cache so far")} {
    auto& family = prometheus::BuildCounter()
                       .Name("tessera_page_requests_total")
                       .Help("Page requests by MIP level and result")
                       .Register(registry);
    for (std::size_t result = 0; result < results; ++result)
        for (std::size_t level = 0; level <= max_level; ++level)
            requests_[result][level] =
                &family.Add({{"result", result_names[result]}, {"level", std::to_string(level)}});
    auto& by_channels = prometheus::BuildCounter()
                            .Name("tessera_page_requests_by_channels_total")
                            .Help("Page requests by channel set")
                            .Register(registry);
    for (const ChannelSet set : channel_sets)
        by_channels_[static_cast<std::size_t>(set)] =
            &by_channels.Add({{"channels", std::string{name_of(set)}}});
}

double PageMetrics::requests(PageResult result) const {
    double sum = 0;
    for (const auto* level : requests_[static_cast<std::size_t>(result)]) sum += level->Value();
    return sum;
}

}  // namespace tessera
