#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "server/filter/footprint_sampler.h"
#include "server/filter/texel_pages.h"
#include "server/sampling/sample_plan.h"
#include "server/sampling/sample_request.h"
#include "server/scene/scene.h"

namespace tessera {

/// Pages of texels of the scenes that are being sampled, shared by everybody, and samplers over them, each
/// lent to one thread at a time. What was used longest ago makes room. All members may be called from any
/// thread.
class SamplerStore {
  public:
    struct Limits {
        std::size_t memory_bytes = std::size_t{512} << 20;  ///< Of pages and samplers together.
        std::size_t samplers = 8;  ///< More than are lent at a time, or nothing is kept between requests.
        std::size_t sources = 6;   ///< Scene, channels, accuracy of the texels, and time.
    };
    /// How pages and samplers are made; tests put in their own.
    struct Makers {
        std::function<std::shared_ptr<const TexelPages>(std::shared_ptr<const Texture>, Accuracy,
                                                        std::size_t)>
            pages = pages_of_texture;
        std::function<std::unique_ptr<FootprintSampler>(const FootprintFilter&,
                                                        std::shared_ptr<const TexelPages>, std::size_t)>
            sampler = make_sampler;
    };

    explicit SamplerStore(const Limits& limits) : SamplerStore{limits, Makers{}} {}
    SamplerStore(const Limits& limits, Makers makers) : limits_{limits}, makers_{std::move(makers)} {}

  private:
    struct Source {
        ScenePtr scene;
        ChannelSet channels;
        Accuracy texels;
        SampleTime time;
        std::shared_ptr<const TexelPages> pages;
        std::uint64_t used = 0;
    };
    struct Idle {
        FootprintFilter filter;
        std::shared_ptr<const TexelPages> pages;
        std::unique_ptr<FootprintSampler> sampler;
        std::uint64_t used = 0;
    };

  public:
    /// A sampler, until this is destroyed; the store outlives it.
    class Loan {
      public:
        Loan(SamplerStore& store, Idle lent) : store_{store}, lent_{std::move(lent)} {}
        Loan(const Loan&) = delete;
        Loan& operator=(const Loan&) = delete;
        ~Loan() { store_.take_back(std::move(lent_)); }
        FootprintSampler* operator->() const noexcept { return lent_.sampler.get(); }

      private:
        SamplerStore& store_;
        Idle lent_;
    };

    /// `scene` has the channels.
    Loan borrow(const ScenePtr& scene, ChannelSet channels, const SampleStep& step,
                const SampleTime& time = {});

    /// Lets go of all scenes: those that are served now are others.
    void forget();

    /// Of the pages that are kept.
    std::size_t page_bytes() const;
    std::size_t idle_samplers() const;
    std::size_t sources() const;

  private:
    std::shared_ptr<const TexelPages> pages_of(const ScenePtr& scene, ChannelSet channels, Accuracy texels,
                                               const SampleTime& time,
                                               std::vector<std::shared_ptr<const void>>& dropped);
    void take_back(Idle lent);
    bool is_kept(const std::shared_ptr<const TexelPages>& pages) const;

    const Limits limits_;
    const Makers makers_;
    mutable std::mutex mutex_;  ///< Guards what follows; never held while texels are evaluated.
    std::vector<Source> sources_;
    std::vector<Idle> idle_;
    std::uint64_t clock_ = 0;
};

}  // namespace tessera
