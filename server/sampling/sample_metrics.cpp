#include "server/sampling/sample_metrics.h"

namespace tessera {
namespace {

prometheus::Family<prometheus::Counter>& counters(prometheus::Registry& registry, const char* name,
                                                  const char* help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

prometheus::Gauge& gauge(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({});
}

}  // namespace

SampleMetrics::SampleMetrics(prometheus::Registry& registry)
    : request_seconds{prometheus::BuildHistogram()
                          .Name("tessera_sample_request_seconds")
                          .Help("Time from a request for samples to its answer")
                          .Register(registry)
                          .Add({},
                               prometheus::Histogram::BucketBoundaries{0.001, 0.002, 0.005, 0.01, 0.02, 0.05,
                                                                       0.1, 0.2, 0.5, 1, 2, 5, 10})},
      waiting{
          gauge(registry, "tessera_sample_requests_waiting", "Requests for samples that have no answer yet")},
      page_bytes{gauge(registry, "tessera_sample_page_bytes", "Bytes of texels kept for samples")},
      samplers{gauge(registry, "tessera_samplers", "Filters kept between requests")} {
    constexpr std::array<const char*, 6> results{"answered",  "malformed", "overloaded",
                                                 "cancelled", "timed_out", "failed"};
    auto& requests = counters(registry, "tessera_sample_requests_total", "Requests for samples by result");
    for (std::size_t i = 0; i < results.size(); ++i) requests_[i] = &requests.Add({{"result", results[i]}});

    auto& samples = counters(registry, "tessera_samples_total",
                             "Footprints sampled, by filter; one that several "
                             "filters were tried on counts for each");
    auto& texels = counters(registry, "tessera_sample_texels_total", "Texels read for footprints, by filter");
    auto& seconds = counters(registry, "tessera_sample_seconds_total", "Time spent on footprints, by filter");
    constexpr std::array<const char*, 10> filters{"nearest",
                                                  "bilinear",
                                                  "trilinear",
                                                  "anisotropic",
                                                  "ewa",
                                                  "summed-area",
                                                  "line-integral",
                                                  "supersampling-grid",
                                                  "supersampling-jittered",
                                                  "exact"};
    static_assert(filters.size() == std::tuple_size_v<decltype(by_filter_)>);
    for (std::size_t i = 0; i < filters.size(); ++i)
        by_filter_[i] = {&samples.Add({{"filter", filters[i]}}), &texels.Add({{"filter", filters[i]}}),
                         &seconds.Add({{"filter", filters[i]}})};
}

void SampleMetrics::count(FilterKind kind, std::size_t samples, std::uint64_t texels,
                          std::chrono::nanoseconds time) noexcept {
    const ByFilter& filter = by_filter_[static_cast<std::size_t>(kind)];
    filter.samples->Increment(static_cast<double>(samples));
    filter.texels->Increment(static_cast<double>(texels));
    filter.seconds->Increment(std::chrono::duration<double>(time).count());
}

}  // namespace tessera
