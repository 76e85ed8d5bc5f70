#pragma once

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/registry.h>

namespace tessera {

/// What Prometheus learns of the streams. All members may be called from any thread.
struct StreamMetrics {
    /// `registry` outlives this.
    explicit StreamMetrics(prometheus::Registry& registry);

    prometheus::Gauge& streams;
    prometheus::Counter& streams_refused;
    prometheus::Counter& streams_cut;  ///< For what their client did or did not do.
    prometheus::Counter& pages;
    prometheus::Counter& pages_unchanged;
    prometheus::Counter& pages_refused;
    prometheus::Counter& bytes;
    prometheus::Counter& invalidations;
    prometheus::Counter& stale_pages;
    prometheus::Counter& revisions_coalesced;  ///< Told together with a later one.
    prometheus::Counter& edits;
    prometheus::Counter& edits_refused;
};

}  // namespace tessera
