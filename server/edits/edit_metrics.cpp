#include "server/edits/edit_metrics.h"

namespace tessera {

namespace {

/// In the order of EditRefusal::Why.
constexpr std::array<const char*, 7> reason_names{"wrong",      "conflict",    "other_content", "too_old",
                                                  "overloaded", "unavailable", "unknown"};

prometheus::Family<prometheus::Gauge>& gauges(prometheus::Registry& registry, const char* name,
                                              const char* help) {
    return prometheus::BuildGauge().Name(name).Help(help).Register(registry);
}

prometheus::Counter& counter(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry).Add({});
}

}  // namespace

EditMetrics::EditMetrics(prometheus::Registry& registry)
    : accepted_{counter(registry, "tessera_edits_accepted_total", "Edits that are in the journal for good")},
      again_{counter(registry, "tessera_edits_again_total", "Retries of edits that were in already")},
      seconds_{prometheus::BuildHistogram()
                   .Name("tessera_edit_seconds")
                   .Help("Time from an edit's arrival to its acknowledgement")
                   .Register(registry)
                   .Add({}, prometheus::Histogram::BucketBoundaries{0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01,
                                                                    0.02, 0.05, 0.1, 0.2, 0.5, 1, 5, 30})},
      revision_{gauges(registry, "tessera_scene_revision", "Edits accepted so far")},
      remembered_{gauges(registry, "tessera_journal_edits", "Edits inside the journal's horizon")},
      since_snapshot_{gauges(registry, "tessera_journal_edits_since_snapshot",
                             "Edits that a restart would have to replay")},
      bytes_{gauges(registry, "tessera_journal_bytes", "Bytes of the edits inside the journal's horizon")},
      trouble_{gauges(registry, "tessera_journal_trouble", "1 while the journal refuses edits")},
      sprites_{gauges(registry, "tessera_scene_sprites", "Sprites in the scene")} {
    auto& refused = prometheus::BuildCounter()
                        .Name("tessera_edits_refused_total")
                        .Help("Edits that are not in, or not known to be, by reason")
                        .Register(registry);
    for (std::size_t reason = 0; reason < reasons; ++reason)
        refused_[reason] = &refused.Add({{"reason", reason_names[reason]}});
}

void EditMetrics::count(const EditOutcome& outcome, std::chrono::nanoseconds time) noexcept {
    if (const auto* refusal = std::get_if<EditRefusal>(&outcome))
        return refused_[static_cast<std::size_t>(refusal->why)]->Increment();
    (std::get<proto::EditAnswer>(outcome).again() ? again_ : accepted_).Increment();
    seconds_.Observe(std::chrono::duration<double>(time).count());
}

void EditMetrics::update(const std::string& scene, const JournalStatus& journal, std::size_t sprites) {
    auto found = scenes_.find(scene);
    if (found == scenes_.end()) {
        const prometheus::Labels labels{{"scene", scene}};
        found = scenes_
                    .emplace(scene, Gauges{revision_.Add(labels), remembered_.Add(labels),
                                           since_snapshot_.Add(labels), bytes_.Add(labels),
                                           trouble_.Add(labels), sprites_.Add(labels)})
                    .first;
    }
    const Gauges& gauges = found->second;
    gauges.revision.Set(static_cast<double>(journal.head));
    gauges.remembered.Set(static_cast<double>(journal.head + 1 - journal.oldest));
    gauges.since_snapshot.Set(static_cast<double>(journal.head - journal.snapshot));
    gauges.bytes.Set(static_cast<double>(journal.bytes));
    gauges.trouble.Set(journal.trouble.empty() ? 0 : 1);
    gauges.sprites.Set(static_cast<double>(sprites));
}

}  // namespace tessera
