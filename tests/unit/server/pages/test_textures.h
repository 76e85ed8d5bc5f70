#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/scene/scene.h"
#include "server/texture/texture.h"

namespace tessera::test {

/// A texture whose evaluations wait at a gate that the test opens, and that counts them.
class GatedTexture final : public Texture {
  public:
    using Texture::evaluate;

    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        ++begun;
        {
            const std::lock_guard lock{mutex_};
            order_.push_back(region);
        }
        changed_.notify_all();
        for (std::unique_lock lock{mutex_}; !open_;) {
            changed_.wait_for(lock, std::chrono::milliseconds{1});
            if (const auto spent = check_budget(budget); !spent) {
                ++stopped;
                return spent.error();
            }
        }
        // Noise, so that no codec gets off lightly and no two pages are equal
        out = LinearImage{region.width, region.height};
        auto state = static_cast<std::uint32_t>(region.x * 7919 + region.y * 104729 + region.level + 1);
        for (float& value : out.values) {
            state = state * 1664525 + 1013904223;
            value = static_cast<float>(state >> 8) / 16777216.0F;
        }
        for (std::size_t i = 3; i < out.values.size(); i += 4) out.values[i] = 1.0F;
        ++finished;
        return Evaluation{"gated", 0.25, 0.5, 7};
    }

    std::string_view kind() const noexcept override { return "gated"; }
    std::string description() const override { return "gated"; }
    std::size_t memory_bytes() const noexcept override { return 0; }

    void open() {
        const std::lock_guard lock{mutex_};
        open_ = true;
        changed_.notify_all();
    }
    /// The regions in the order in which their evaluations began.
    std::vector<TexelRegion> order() const {
        const std::lock_guard lock{mutex_};
        return order_;
    }

    mutable std::atomic<int> begun = 0, finished = 0, stopped = 0;

  private:
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    mutable std::vector<TexelRegion> order_;
    bool open_ = false;
};

inline ScenePtr make_scene(std::string id, std::shared_ptr<const Texture> texture,
                           std::string fingerprint = "0123456789abcdef") {
    auto scene = std::make_shared<Scene>();
    scene->id = std::move(id);
    scene->title = "A scene of the tests";
    scene->fingerprint = std::move(fingerprint);
    scene->texture = std::move(texture);
    return scene;
}

/// Waits until `condition` holds; false after ten seconds, which is long on a machine under sanitizers.
template <class Condition>
bool eventually(Condition condition) {
    for (int i = 0; i < 10'000; ++i) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    return condition();
}

}  // namespace tessera::test
