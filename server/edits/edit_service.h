#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

#include "server/edits/edit_metrics.h"
#include "server/edits/live_scene.h"

namespace tessera {

struct EditOptions {
    std::filesystem::path
        folder;  ///< Holds a journal for each scene; empty: edits last as long as the process.
    JournalHorizon horizon;
};

/// The scenes that take edits: all that have something to edit. All members may be called from any thread.
class EditService {
  public:
    /// `registry` outlives this.
    EditService(EditOptions options, prometheus::Registry& registry)
        : options_{std::move(options)}, metrics_{registry} {}

    /// Makes `catalog` show its scenes with their edits: opens the journals of those that are new, and puts
    /// new grounds under those that were there. A scene whose journal cannot be opened becomes a problem of
    /// the catalog: without edits that were acknowledged it would be another. Only where there never was a
    /// journal it is shown as its folder says, and refuses edits with the reason.
    void adopt(Catalog& catalog, Progress& progress);

    /// Closes all scenes: everybody is answered when it returns. Idempotent.
    void close();

    /// As LiveScene::edit(). Refuses edits of scenes that take none.
    void edit(std::string_view scene, proto::Edit edit, LiveScene::Handler handler);

    /// Null if it takes no edits.
    std::shared_ptr<LiveScene> find(std::string_view scene) const;

    /// Brings what Prometheus learns of the scenes up to date.
    void update_gauges();

  private:
    Result<std::shared_ptr<LiveScene>> open(const ScenePtr& scene, Progress& progress) const;
    bool may_have_journal(const std::string& scene) const;

    const EditOptions options_;
    EditMetrics metrics_;
    std::mutex updating_;       ///< Held while gauges are updated.
    mutable std::mutex mutex_;  ///< Guards what follows.
    std::map<std::string, std::shared_ptr<LiveScene>, std::less<>> scenes_;
    std::set<std::string, std::less<>> resting_;   ///< Of these: their files take no edits now.
    std::set<std::string, std::less<>> troubled_;  ///< Whose journals could not be made.
};

}  // namespace tessera
