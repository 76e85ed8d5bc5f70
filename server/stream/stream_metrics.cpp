#include "server/stream/stream_metrics.h"

namespace tessera {
namespace {

prometheus::Counter& counter(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry).Add({});
}

}  // namespace

StreamMetrics::StreamMetrics(prometheus::Registry& registry)
    : streams{prometheus::BuildGauge()
                  .Name("tessera_streams")
                  .Help("Open streams (WebSockets)")
                  .Register(registry)
                  .Add({})},
      streams_refused{counter(registry, "tessera_streams_refused_total",
                              "Streams answered with 503 because there were too many")},
      streams_cut{counter(registry, "tessera_streams_cut_total",
                          "Streams ended for what their client sent, or because it did not read or answer")},
      pages{
          counter(registry, "tessera_stream_pages_total", "Pages sent on streams, those unchanged included")},
      pages_unchanged{counter(registry, "tessera_stream_pages_unchanged_total",
                              "Pages whose copy at the client was right, so that no texels were sent")},
      pages_refused{counter(registry, "tessera_stream_pages_refused_total",
                            "Asks for pages that were refused, those cancelled included")},
      bytes{counter(registry, "tessera_stream_sent_bytes_total", "Bytes of messages sent on streams")},
      invalidations{
          counter(registry, "tessera_stream_invalidations_total", "Messages that tell stale pages")},
      stale_pages{counter(registry, "tessera_stream_stale_pages_total", "Pages told to be stale")},
      revisions_coalesced{counter(registry, "tessera_stream_revisions_coalesced_total",
                                  "Revisions that were told together with a later one")},
      edits{counter(registry, "tessera_stream_edits_total", "Edits that arrived on streams")},
      edits_refused{counter(registry, "tessera_stream_edits_refused_total",
                            "Edits that arrived on streams and were refused")} {}

}  // namespace tessera
