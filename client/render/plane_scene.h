#pragma once

#include <memory>

#include "client/render/page_store.h"
#include "client/render/page_table_texture.h"
#include "client/render/plane_renderer.h"
#include "client/residency/residency.h"

namespace tessera {

/// One virtual texture on the plane: its residency, and the GL objects that follow it.
class PlaneScene {
  public:
    /// Needs a current context; `source` outlives this. Error: io_failure with the driver's words.
    static Result<std::unique_ptr<PlaneScene>> make(Extent extent, PageSource& source,
                                                    const ResidencySettings& settings);

    /// Decides what is resident for this view, and brings new pages and entries to the GPU.
    ResidencyFrame update(const PlaneView& view, ClientTime now);

    /// Draws the view of the last update(). `style.lod_bias` and `style.now_ms` are set here.
    void draw(const FrameTarget& target, const PlaneView& view, PlaneStyle style);

    const Residency& residency() const { return residency_; }
    const PageStore& pages() const { return pages_; }

  private:
    PlaneScene(Extent extent, PageSource& source, const ResidencySettings& settings,
               std::unique_ptr<PlaneRenderer> renderer);

    Residency residency_;
    PageStore pages_;
    PageTableTexture table_;
    std::unique_ptr<PlaneRenderer> renderer_;
    double lod_bias_ = 0;
    ClientTime now_{};
    ClientTime last_upload_{};
};

}  // namespace tessera
