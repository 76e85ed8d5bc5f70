#include "server/http/http_metrics.h"

#include <string>

namespace tessera {
namespace {

prometheus::Gauge& gauge(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({});
}

prometheus::Counter& counter(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry).Add({});
}

}  // namespace

HttpMetrics::HttpMetrics(prometheus::Registry& registry)
    : connections{gauge(registry, "tessera_http_connections", "Open connections")},
      connections_refused{counter(registry, "tessera_http_connections_refused_total",
                                  "Connections answered with 503 because there were too many")},
      reloads_failed{
          counter(registry, "tessera_reloads_failed_total", "Reloads that kept the scenes as they were")},
      scenes{gauge(registry, "tessera_scenes", "Scenes that are served")},
      scenes_broken{gauge(registry, "tessera_scenes_broken", "Scene folders that could not be loaded")},
      bytes_{counter(registry, "tessera_http_sent_bytes_total", "Bytes of message bodies sent")} {
    auto& family = prometheus::BuildCounter()
                       .Name("tessera_http_answers_total")
                       .Help("Answers by HTTP status")
                       .Register(registry);
    for (const unsigned status : {101u, 200u, 204u, 304u, 308u, 400u, 401u, 403u, 404u, 405u, 406u, 408u,
                                  409u, 410u, 411u, 413u, 414u, 415u, 417u, 426u, 431u, 500u, 501u, 503u})
        answers_[status] = &family.Add({{"status", std::to_string(status)}});
}

}  // namespace tessera
