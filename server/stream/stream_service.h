#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include <prometheus/registry.h>

#include "server/edits/edit_service.h"
#include "server/pages/page_service.h"
#include "server/stream/scene_hub.h"
#include "server/stream/stream_metrics.h"
#include "server/stream/stream_options.h"
#include "shared/motion/scene_clock.h"

namespace tessera {

/// What all streams of the server share. All members may be called from any thread.
class StreamService {
  public:
    /// All outlive this.
    StreamService(const StreamOptions& given, PageService& page_service, EditService& edit_service,
                  prometheus::Registry& registry)
        : options{given}, pages{page_service}, edits{edit_service}, metrics{registry} {}

    /// One of the streams that there may be, until the pointer is let go; null: there are too many.
    std::shared_ptr<void> admit();

    std::shared_ptr<SceneHub> hub(const std::string& scene);
    /// Scenes were loaded: edits of those that are new are listened to.
    void follow_scenes();

    std::uint64_t new_session() noexcept { return ++sessions_; }

    /// That edits set; scenes that take none showed step 0 when the server started.
    SceneClock clock_of(const Scene& scene) const;

    const StreamOptions options;
    PageService& pages;
    EditService& edits;
    StreamMetrics metrics;

  private:
    const SceneClock::Time started_ =
        std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
    std::atomic<std::size_t> streams_ = 0;
    std::atomic<std::uint64_t> sessions_ = 0;
    std::mutex mutex_;  ///< Guards hubs_.
    std::map<std::string, std::shared_ptr<SceneHub>, std::less<>> hubs_;
};

}  // namespace tessera
