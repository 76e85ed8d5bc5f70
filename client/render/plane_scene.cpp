#include "client/render/plane_scene.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <vector>

namespace tessera {

Result<std::unique_ptr<PlaneScene>> PlaneScene::make(Extent extent, PageSource& source,
                                                     const ResidencySettings& settings) {
    PlaneRenderer renderer{extent};
    if (const auto ready = renderer.prepare({}); !ready) return ready.error();
    std::unique_ptr<PlaneScene> scene{new PlaneScene{extent, source, settings, std::move(renderer)}};
    auto pages = PageStore::make(scene->residency_.slots());
    if (!pages) return pages.error();
    scene->pages_ = std::move(*pages);
    return scene;
}

/// Its store is made where an error can be told.
PlaneScene::PlaneScene(Extent extent, PageSource& source, const ResidencySettings& settings,
                       PlaneRenderer renderer)
    : residency_{extent, source, settings},
      pages_{1},
      table_{extent, settings.window_side},
      renderer_{std::move(renderer)} {}

ResidencyFrame PlaneScene::update(const PlaneView& view, FrameTime time, FilterChoice filter) {
    ResidencyFrame frame = residency_.update(view, time, sampling_of(filter));
    // From now on sums are made while texels are at hand; draw() says why if there is no room
    const bool sums = filter.filter == Filter::line_integral ||
                      (view.split() && view.split()->right.kind == Sampling::Kind::line_integral);
    if (sums) static_cast<void>(begin_integrals(frame.sampled));
    const auto begin = std::chrono::steady_clock::now();
    for (const SlotUpload& upload : frame.uploads) {
        pages_.upload(upload.slot, upload.texels);
        if (!integrals_) continue;
        integrals_->forget(upload.slot);
        if (sums) integrals_->upload(upload.slot, upload.texels);
    }
    coarsest_changed_ = std::max(coarsest_changed_, table_.update(residency_.table()));
    upload_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    budget_.spent(frame.uploads.size(), upload_ms_);
    if (!frame.uploads.empty()) last_upload_ = time.now;
    lod_bias_ = frame.lod_bias;
    now_ = time.now;
    return frame;
}

/// The coarsest page too: so there is something to show everywhere.
Result<void> PlaneScene::begin_integrals(std::span<const NeededPage> sampled) {
    if (no_integrals_) return *no_integrals_;
    if (!integrals_)
        integrals_.emplace(residency_.extent(), residency_.settings().window_side, residency_.slots());
    std::set<Slot> shown;
    const PageTable& table = residency_.table();
    if (const auto top = table.shown_for({residency_.extent().n, 0, 0})) shown.insert(top->slot);
    for (const NeededPage& page : sampled)
        if (const auto found = table.shown_for(page.key)) shown.insert(found->slot);
    const auto begun = integrals_->begin_frame(std::vector<Slot>(shown.begin(), shown.end()));
    if (!begun) {
        no_integrals_ = begun.error();
        integrals_.reset();
    }
    return begun;
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
    static_cast<void>(table_.update(residency_.table()));
    return {};
}

Result<void> PlaneScene::draw(const FrameTarget& target, const PlaneView& view, PlaneStyle style,
                              GLuint feedback) {
    style.lod_bias = lod_bias_;
    style.now_ms = static_cast<std::uint32_t>(now_.count());
    if (now_ - last_upload_ > std::chrono::duration<float, std::milli>{style.fade_ms}) style.fade_ms = 0;
    if (style.filter.filter == Filter::line_integral) {
        if (no_integrals_) return *no_integrals_;
        if (!integrals_)
            if (const auto begun = begin_integrals({}); !begun) return begun.error();
        integrals_->bring(pages_.coded_texture(), residency_.table(), coarsest_changed_);
        coarsest_changed_ = -1;
    }
    if (style.overlay == Overlay::revision) marks_.update(residency_);
    return renderer_.draw(target, view,
                          textures(held_sprites_.prepare(held_, view) ? &held_sprites_ : nullptr, feedback),
                          residency_.settings().window_side, style);
}

TexelTextures PlaneScene::textures(const HeldSprites* held, GLuint feedback) const {
    return {.colour = pages_.texture(),
            .coded = pages_.coded_texture(),
            .table = table_.texture(),
            .entries = table_.entries(),
            .integrals = integrals_ ? integrals_->texture() : 0,
            .integral_table = integrals_ ? integrals_->table() : 0,
            .held = held,
            .feedback = feedback,
            .marks = marks_.texture()};
}

Result<void> PlaneScene::warm_up(const PlaneView& view, FilterChoice filter) {
    constexpr int side = 32;  // pixels: enough for near rows and far ones
    const FrameTarget unseen{side, side};
    const PlaneView small{view.camera(), side, side, view.surface()};
    TexelTextures texels = textures(nullptr, 0);
    std::unique_ptr<IntegralStore> integrals;  // sums of one page: the real ones take long, and much room
    if (filter.filter == Filter::line_integral) {
        auto made = IntegralStore::make(1);
        if (!made) return made.error();
        integrals = std::move(made.value());
        integrals->upload_from(pages_.coded_texture(), gutter_texels, 0, 0);  // reading back is slow at first
        texels.integrals = integrals->texture();
        texels.integral_table = table_.texture();
    }
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
