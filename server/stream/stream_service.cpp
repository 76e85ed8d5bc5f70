#include "server/stream/stream_service.h"

namespace tessera {

std::shared_ptr<void> StreamService::admit() {
    if (++streams_ > options.streams) {
        --streams_;
        metrics.streams_refused.Increment();
        return nullptr;
    }
    metrics.streams.Increment();
    return {this, [this](void*) {
                --streams_;
                metrics.streams.Decrement();
            }};
}

std::shared_ptr<SceneHub> StreamService::hub(const std::string& scene) {
    const std::lock_guard lock{mutex_};
    std::shared_ptr<SceneHub>& hub = hubs_[scene];
    if (!hub) {
        hub = std::make_shared<SceneHub>();
        hub->follow(edits.find(scene));
    }
    return hub;
}

void StreamService::follow_scenes() {
    const std::lock_guard lock{mutex_};
    for (const auto& [scene, hub] : hubs_) hub->follow(edits.find(scene));
}

SceneClock StreamService::clock_of(const Scene& scene) const {
    if (scene.clock) return *scene.clock;
    SceneClock clock;
    clock.at = started_;
    clock.steps_per_second = scene.steps_per_second;
    clock.loop_steps = scene.loop_steps;
    clock.playing = scene.animated;
    return clock;
}

}  // namespace tessera
