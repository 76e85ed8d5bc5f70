#pragma once

#include <memory>
#include <optional>
#include <span>

#include "client/render/held_sprites.h"
#include "client/render/page_integrals.h"
#include "client/render/page_marks.h"
#include "client/render/page_store.h"
#include "client/render/page_table_texture.h"
#include "client/render/plane_renderer.h"
#include "client/render/upload_budget.h"
#include "client/residency/residency.h"

namespace tessera {

/// One virtual texture on a surface: its residency, and the GL objects that follow it.
class PlaneScene {
  public:
    /// Needs a current context; `source` outlives this. Error: io_failure with the driver's words.
    static Result<std::unique_ptr<PlaneScene>> make(Extent extent, PageSource& source,
                                                    const ResidencySettings& settings);

    /// Decides what is resident for this view under this filter, and brings new pages and entries to the GPU.
    ResidencyFrame update(const PlaneView& view, FrameTime time, FilterChoice filter = {});

    /// At most so many pages come in each update() from now on, at least 1.
    void set_uploads_per_frame(std::size_t most) { residency_.set_uploads_per_frame(most); }
    /// By what bringing pages took so far.
    const UploadBudget& upload_budget() const { return budget_; }
    /// What the last update() took to bring pages and entries to the GPU.
    double upload_ms() const { return upload_ms_; }

    /// Changes that are drawn over the pages from the next update() on.
    void hold(std::vector<PageHold> holds) { residency_.hold(std::move(holds)); }
    /// What hands hold in the next draw(): over the pages, in this order.
    void show_held(std::vector<HeldSprite> sprites) { held_ = std::move(sprites); }
    HeldSprites& held_patterns() { return held_sprites_; }
    const HeldSprites& held_patterns() const { return held_sprites_; }

    /// Draws the view of the last update(), which was for the same filter. `style.lod_bias` and
    /// `style.now_ms` are set here. Error: io_failure (the driver refuses the filter's shader, or has no
    /// room); nothing is drawn then.
    /// `feedback`: see TexelTextures, where the style asks for it.
    Result<void> draw(const FrameTarget& target, const PlaneView& view, PlaneStyle style,
                      GLuint feedback = 0);

    /// Draws some pixels by this filter that nobody sees, so that its first frame need not wait for the
    /// driver to compile: takes as long as that, and belongs where nobody waits. Error: as in draw().
    Result<void> warm_up(const PlaneView& view, FilterChoice filter);

    /// The cache has so many slots from now on; what is resident stays, as far as there is room. Error:
    /// io_failure (no room on the GPU); nothing has changed then.
    Result<void> resize(std::size_t slots);

    const Residency& residency() const { return residency_; }
    const PageStore& pages() const { return pages_; }
    const PageTableTexture& page_table() const { return table_; }
    /// How many pages there are line integrals of, or places for.
    std::size_t integral_places() const { return integrals_ ? integrals_->places() : 0; }
    /// Of pages, and of their line integrals once those were needed.
    std::size_t gpu_bytes() const { return pages_.bytes() + (integrals_ ? integrals_->bytes() : 0); }

  private:
    PlaneScene(Extent extent, PageSource& source, const ResidencySettings& settings, PlaneRenderer renderer);
    /// Places for the line integrals of all that the view samples. Where there was no room it is not tried
    /// again before resize().
    Result<void> begin_integrals(std::span<const NeededPage> sampled);
    TexelTextures textures(const HeldSprites* held, GLuint feedback) const;

    Residency residency_;
    PageStore pages_;
    PageTableTexture table_;
    PlaneRenderer renderer_;
    PageMarks marks_;
    HeldSprites held_sprites_;
    std::vector<HeldSprite> held_;
    std::optional<PageIntegrals> integrals_;  ///< Made when Filter::line_integral is first drawn
    std::optional<Error> no_integrals_;       ///< Why there is no room for them, until resize()
    int coarsest_changed_ = -1;               ///< Level of the table, since `integrals_` followed it
    UploadBudget budget_;
    double upload_ms_ = 0;
    double lod_bias_ = 0;
    ClientTime now_{};
    ClientTime last_upload_{};
};

}  // namespace tessera
