#include "client/render/plane_scene.h"

namespace tessera {

Result<std::unique_ptr<PlaneScene>> PlaneScene::make(Extent extent, PageSource& source,
                                                     const ResidencySettings& settings) {
    auto renderer = PlaneRenderer::make(extent);
    if (!renderer) return renderer.error();
    return std::unique_ptr<PlaneScene>{new PlaneScene{extent, source, settings, std::move(renderer.value())}};
}

PlaneScene::PlaneScene(Extent extent, PageSource& source, const ResidencySettings& settings,
                       std::unique_ptr<PlaneRenderer> renderer)
    : residency_{extent, source, settings},
      pages_{settings.slots},
      table_{extent, settings.window_side},
      renderer_{std::move(renderer)} {}

ResidencyFrame PlaneScene::update(const PlaneView& view, ClientTime now) {
    ResidencyFrame frame = residency_.update(view, now);
    for (const SlotUpload& upload : frame.uploads) pages_.upload(upload.slot, upload.texels);
    table_.update(residency_.table());
    if (!frame.uploads.empty()) last_upload_ = now;
    lod_bias_ = frame.lod_bias;
    now_ = now;
    return frame;
}

void PlaneScene::draw(const FrameTarget& target, const PlaneView& view, PlaneStyle style) {
    style.lod_bias = lod_bias_;
    style.now_ms = static_cast<std::uint32_t>(now_.count());
    if (now_ - last_upload_ > std::chrono::duration<float, std::milli>{style.fade_ms}) style.fade_ms = 0;
    renderer_->draw(target, view, pages_, table_, residency_.settings().window_side, style);
}

}  // namespace tessera
