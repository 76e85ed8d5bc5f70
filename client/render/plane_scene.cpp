#include "client/render/plane_scene.h"

#include <chrono>
#include <vector>

namespace tessera {

Result<std::unique_ptr<PlaneScene>> PlaneScene::make(Extent extent, PageSource& source,
                                                     const ResidencySettings& settings) {
    PlaneRenderer renderer{extent};
    if (const auto ready = renderer.prepare({}); !ready) return ready.error();
    return std::unique_ptr<PlaneScene>{new PlaneScene{extent, source, settings, std::move(renderer)}};
}

PlaneScene::PlaneScene(Extent extent, PageSource& source, const ResidencySettings& settings,
                       PlaneRenderer renderer)
    : residency_{extent, source, settings},
      pages_{residency_.slots()},
      table_{extent, settings.window_side},
      renderer_{std::move(renderer)} {}

ResidencyFrame PlaneScene::update(const PlaneView& view, FrameTime time, FilterChoice filter) {
    ResidencyFrame frame = residency_.update(view, time, sampling_of(filter));
    // From now on sums are made while texels are at hand; draw() says why if there is no room
    const bool sums = filter.filter == Filter::line_integral ||
                      (view.split() && view.split()->right.kind == Sampling::Kind::line_integral);
    if (sums) static_cast<void>(make_integrals());
    const auto begin = std::chrono::steady_clock::now();
    for (const SlotUpload& upload : frame.uploads) {
        pages_.upload(upload.slot, upload.texels);
        // Summed while its texels are at hand where sums are wanted; else remembered
        if (integrals_ && sums) {
            integrals_->upload(upload.slot, upload.texels, gutter_texels);
            without_integrals_.erase(upload.slot);
        } else {
            without_integrals_.insert(upload.slot);
        }
    }
    table_.update(residency_.table());
    upload_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    budget_.spent(frame.uploads.size(), upload_ms_);
    if (!frame.uploads.empty()) last_upload_ = time.now;
    lod_bias_ = frame.lod_bias;
    now_ = time.now;
    return frame;
}

Result<void> PlaneScene::make_integrals() {
    if (integrals_) return {};
    if (!no_integrals_) {
        auto made = IntegralStore::make(residency_.slots());
        if (made)
            integrals_ = std::move(made.value());
        else
            no_integrals_ = made.error();
    }
    return no_integrals_ ? Result<void>{*no_integrals_} : Result<void>{};
}

/// Before a page is shown by its integrals, they are there.
Result<void> PlaneScene::bring_integrals() {
    if (const auto there = make_integrals(); !there) return there.error();
    const std::vector<int> slots(without_integrals_.begin(), without_integrals_.end());
    integrals_->upload_from(pages_.coded_texture(), gutter_texels, slots);
    without_integrals_.clear();
    return {};
}

Result<void> PlaneScene::resize(std::size_t slots) {
    auto pages =
        PageStore::make(residency_.cache_slots(slots) + residency_.slots() - residency_.cache().capacity());
    if (!pages) return pages.error();
    const SlotCache::Resized resized = residency_.resize(slots);
    pages->copy_from(pages_, resized.moves);
    pages_ = std::move(pages.value());
    // Sums are made again where they are wanted
    integrals_.reset();
    no_integrals_.reset();
    without_integrals_.clear();
    for (const auto& [page, slot] : residency_.cache().pages()) without_integrals_.insert(slot);
    table_.update(residency_.table());
    return {};
}

Result<void> PlaneScene::draw(const FrameTarget& target, const PlaneView& view, PlaneStyle style,
                              GLuint feedback) {
    style.lod_bias = lod_bias_;
    style.now_ms = static_cast<std::uint32_t>(now_.count());
    if (now_ - last_upload_ > std::chrono::duration<float, std::milli>{style.fade_ms}) style.fade_ms = 0;
    if (style.filter.filter == Filter::line_integral)
        if (const auto there = bring_integrals(); !there) return there.error();
    if (style.overlay == Overlay::revision) marks_.update(residency_);
    return renderer_.draw(
        target, view,
        textures(integrals_.get(), held_sprites_.prepare(held_, view) ? &held_sprites_ : nullptr, feedback),
        residency_.settings().window_side, style);
}

TexelTextures PlaneScene::textures(const IntegralStore* integrals, const HeldSprites* held,
                                   GLuint feedback) const {
    return {.colour = pages_.texture(),
            .coded = pages_.coded_texture(),
            .table = table_.texture(),
            .entries = table_.entries(),
            .integrals = integrals ? integrals->texture() : 0,
            .held = held,
            .feedback = feedback,
            .marks = marks_.texture()};
}

Result<void> PlaneScene::warm_up(const PlaneView& view, FilterChoice filter) {
    constexpr int side = 32;  // pixels: enough for near rows and far ones
    const FrameTarget unseen{side, side};
    const PlaneView small{view.camera(), side, side, view.surface()};
    std::unique_ptr<IntegralStore> integrals;  // sums of no page: the real ones take long, and much room
    if (filter.filter == Filter::line_integral && !integrals_) {
        auto made = IntegralStore::make(1);
        if (!made) return made.error();
        integrals = std::move(made.value());
    }
    const TexelTextures texels = textures(integrals ? integrals.get() : integrals_.get(), nullptr, 0);
    // With and without pages that fade in
    for (const float fade_ms : {0.0F, 1.0F}) {
        const PlaneStyle style{.filter = filter, .fade_ms = fade_ms};
        if (const auto drawn =
                renderer_.draw(unseen, small, texels, residency_.settings().window_side, style);
            !drawn)
            return drawn.error();
    }
    return {};
}

}  // namespace tessera
