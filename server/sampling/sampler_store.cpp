#include "server/sampling/sampler_store.h"

#include <algorithm>

namespace tessera {
namespace {

/// The part of the memory that pages take; samplers, which keep their own copies and tables, take the rest.
constexpr std::size_t page_share_percent = 40;

/// A texture as it is at a step.
class TextureAt final : public Texture {
  public:
    TextureAt(std::shared_ptr<const Texture> texture, const SampleTime& time)
        : texture_{std::move(texture)}, time_{time} {}
    Result<Evaluation> evaluate(const TexelRegion& region, const Budget& budget,
                                LinearImage& out) const override {
        TexelRegion then = region;
        then.step = time_.step;
        then.parameter = time_.parameter;
        return texture_->evaluate(then, budget, out);
    }
    using Texture::evaluate;
    TexelKind texel_kind() const noexcept override { return texture_->texel_kind(); }
    std::string_view kind() const noexcept override { return texture_->kind(); }
    std::string description() const override { return texture_->description(); }
    std::size_t memory_bytes() const noexcept override { return texture_->memory_bytes(); }

  private:
    std::shared_ptr<const Texture> texture_;
    SampleTime time_;
};

constexpr auto used_before = [](const auto& a, const auto& b) { return a.used < b.used; };

}  // namespace

SamplerStore::Loan SamplerStore::borrow(const ScenePtr& scene, ChannelSet channels, const SampleStep& step,
                                        const SampleTime& time) {
    std::vector<std::shared_ptr<const void>> dropped;  // destroyed after the lock is released
    std::vector<Idle> dropped_samplers;
    std::shared_ptr<const TexelPages> pages;
    {
        const std::lock_guard lock{mutex_};
        pages = pages_of(scene, channels, step.texels, time, dropped);
        for (auto idle = idle_.begin(); idle != idle_.end();)
            if (is_kept(idle->pages)) {
                ++idle;
            } else {
                dropped_samplers.push_back(std::move(*idle));
                idle = idle_.erase(idle);
            }
        const auto fits = std::find_if(idle_.begin(), idle_.end(), [&](const Idle& idle) {
            return idle.filter == step.filter && idle.pages == pages;
        });
        if (fits != idle_.end()) {
            Idle lent = std::move(*fits);
            idle_.erase(fits);
            return {*this, std::move(lent)};
        }
    }
    const std::size_t sampler_bytes =
        limits_.memory_bytes / 100 * (100 - page_share_percent) / std::max<std::size_t>(limits_.samplers, 1);
    auto sampler = makers_.sampler(step.filter, pages, sampler_bytes);
    return {*this, {step.filter, std::move(pages), std::move(sampler), 0}};
}

/// The lock is held.
std::shared_ptr<const TexelPages> SamplerStore::pages_of(const ScenePtr& scene, ChannelSet channels,
                                                         Accuracy texels, const SampleTime& time,
                                                         std::vector<std::shared_ptr<const void>>& dropped) {
    const auto known = std::find_if(sources_.begin(), sources_.end(), [&](const Source& source) {
        return source.scene == scene && source.channels == channels && source.texels == texels &&
               source.time == time;
    });
    if (known != sources_.end()) {
        known->used = ++clock_;
        return known->pages;
    }
    // A scene of this name that is not served any more goes first
    for (auto old = sources_.begin(); old != sources_.end();)
        if (old->scene != scene && old->scene->id == scene->id) {
            dropped.push_back(std::move(old->pages));
            dropped.push_back(std::move(old->scene));
            old = sources_.erase(old);
        } else {
            ++old;
        }
    if (sources_.size() >= std::max<std::size_t>(limits_.sources, 1)) {
        const auto oldest = std::min_element(sources_.begin(), sources_.end(), used_before);
        dropped.push_back(std::move(oldest->pages));
        dropped.push_back(std::move(oldest->scene));
        sources_.erase(oldest);
    }
    const std::size_t bytes =
        limits_.memory_bytes / 100 * page_share_percent / std::max<std::size_t>(limits_.sources, 1);
    std::shared_ptr<const Texture> texture{scene, scene->texture_of(channels)};
    if (time != SampleTime{}) texture = std::make_shared<TextureAt>(std::move(texture), time);
    sources_.push_back({scene, channels, texels, time, makers_.pages(texture, texels, bytes), ++clock_});
    return sources_.back().pages;
}

bool SamplerStore::is_kept(const std::shared_ptr<const TexelPages>& pages) const {
    return std::any_of(sources_.begin(), sources_.end(),
                       [&](const Source& source) { return source.pages == pages; });
}

void SamplerStore::take_back(Idle lent) {
    Idle dropped;
    const std::lock_guard lock{mutex_};
    if (!is_kept(lent.pages)) {
        dropped = std::move(lent);
        return;
    }
    lent.used = ++clock_;
    idle_.push_back(std::move(lent));
    if (idle_.size() <= limits_.samplers) return;
    const auto oldest = std::min_element(idle_.begin(), idle_.end(), used_before);
    dropped = std::move(*oldest);
    idle_.erase(oldest);
}

void SamplerStore::forget() {
    std::vector<Source> sources;
    std::vector<Idle> idle;
    const std::lock_guard lock{mutex_};
    sources.swap(sources_);
    idle.swap(idle_);
}

std::size_t SamplerStore::page_bytes() const {
    std::vector<std::shared_ptr<const TexelPages>> all;
    {
        const std::lock_guard lock{mutex_};
        for (const Source& source : sources_) all.push_back(source.pages);
    }
    std::size_t bytes = 0;
    for (const auto& pages : all) bytes += pages->memory_bytes();
    return bytes;
}

std::size_t SamplerStore::idle_samplers() const {
    const std::lock_guard lock{mutex_};
    return idle_.size();
}

std::size_t SamplerStore::sources() const {
    const std::lock_guard lock{mutex_};
    return sources_.size();
}

}  // namespace tessera
