#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "server/sampling/sampler_store.h"
#include "tests/unit/server/pages/test_textures.h"

namespace tessera::test {

/// What made samplers share: a gate that the test opens, and counts.
struct MadeFilters {
    std::atomic<bool> open = true;
    std::atomic<int> pages_made = 0, samplers_made = 0, samplers_alive = 0, begun = 0, at_a_time = 0,
                     most_at_a_time = 0;
    std::atomic<int> errors_left = 0;

    SamplerStore::Makers makers();
};

class MadePages final : public TexelPages {
  public:
    MadePages(std::shared_ptr<const Texture> texture, Accuracy texels)
        : accuracy{texels}, texture_{std::move(texture)} {}
    Result<std::shared_ptr<const TexelPage>> page(std::uint8_t, std::int64_t, std::int64_t, std::int64_t,
                                                  const Budget&) const override {
        return Error{ErrorCode::io_failure, "not asked"};
    }
    std::size_t memory_bytes() const noexcept override { return 1000; }

    const Accuracy accuracy;

  private:
    std::shared_ptr<const Texture> texture_;
};

/// Colours that tell the footprint and the slice; the texels' accuracy is in alpha, as 0, 0.5 and 1.
class MadeSampler final : public FootprintSampler {
  public:
    MadeSampler(MadeFilters& shared, const FootprintFilter& filter, std::shared_ptr<const TexelPages> pages)
        : shared_{shared}, filter_{filter}, pages_{std::move(pages)} {
        ++shared_.samplers_made;
        ++shared_.samplers_alive;
    }
    ~MadeSampler() override { --shared_.samplers_alive; }

    Result<void> sample(std::span<const Footprint> footprints, const Budget& budget,
                        std::span<FilteredSample> samples) override {
        ++shared_.begun;
        const int now = ++shared_.at_a_time;
        for (int most = shared_.most_at_a_time; now > most;)
            if (shared_.most_at_a_time.compare_exchange_weak(most, now)) break;
        Result<void> result;
        while (!shared_.open) {
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
            if (result = check_budget(budget); !result) break;
        }
        if (result && shared_.errors_left > 0 && shared_.errors_left-- > 0)
            result = Error{ErrorCode::io_failure, "made to fail"};
        const Accuracy texels = static_cast<const MadePages&>(*pages_).accuracy;
        for (std::size_t i = 0; i < footprints.size() && result; ++i) {
            const Footprint& f = footprints[i];
            const bool exact = filter_.kind == FilterKind::exact;
            samples[i].color = {static_cast<float>(f.x % 1000) / 1000.0F, static_cast<float>(f.corners[0].x),
                                static_cast<float>(f.slice),
                                texels == Accuracy::fast   ? 0.0F
                                : texels == Accuracy::high ? 0.5F
                                                           : 1.0F};
            samples[i].bound_codes = exact ? 0.125 : 8;
            samples[i].confidence = texels == Accuracy::exact ? 1 : 0.999;
            samples[i].texels = 10;
        }
        --shared_.at_a_time;
        return result;
    }

  private:
    MadeFilters& shared_;
    FootprintFilter filter_;
    std::shared_ptr<const TexelPages> pages_;
};

inline SamplerStore::Makers MadeFilters::makers() {
    return {[this](std::shared_ptr<const Texture> texture, Accuracy accuracy, std::size_t) {
                ++pages_made;
                return std::make_shared<const MadePages>(std::move(texture), accuracy);
            },
            [this](const FootprintFilter& filter, std::shared_ptr<const TexelPages> pages, std::size_t) {
                return std::make_unique<MadeSampler>(*this, filter, std::move(pages));
            }};
}

/// A scene whose texture nobody evaluates.
inline ScenePtr scene_to_sample(std::string id = "scene") {
    return make_scene(std::move(id), std::make_shared<GatedTexture>());
}

}  // namespace tessera::test
