#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/residency/camera_motion.h"
#include "client/residency/needed_pages.h"
#include "client/residency/page_holds.h"
#include "client/residency/page_requests.h"
#include "client/residency/page_table.h"
#include "client/residency/page_versions.h"
#include "client/residency/slot_cache.h"
#include "client/residency/slot_upload.h"
#include "client/residency/stand_ins.h"
#include "client/residency/watched_windows.h"

namespace tessera {

struct ResidencySettings {
    /// Pages in the cache: 64 to 2048. The view needs up to about 70 pages at 800×700, and more on larger
    /// screens; each takes 279 KB of GPU memory. Too few and the picture is blurred on purpose (lod_bias).
    std::size_t slots = 512;
    /// Entries along a side of each level's window: 32 reaches far enough for pictures up to about 1200
    /// pixels wide, 64 up to 2400, 128 beyond. Too small blurs the sides.
    int window_side = 32;
    /// Levels from the coarsest down that never leave the cache, so that there is always something to show.
    int pinned_levels = 3;
    /// New pages a frame: too many make the frame late, too few make the picture late.
    std::size_t uploads_per_frame = 8;
    /// Pages are asked for before they are seen, where the camera is going; false: only once they are.
    bool prefetch = true;
    /// Slots behind those of the cache, for pages without what a hand has lifted (StandIns).
    std::size_t stand_ins = 32;
    /// Pages that wait for each other while an edit of our own is brought in (PageHolds), 279 KB each: too
    /// few and a large edit is seen blurred for a moment.
    std::size_t kept = 128;
    RequestLimits requests{};
};

/// Enough entries a side for a picture so many pixels wide.
int window_side_for(int width_pixels);

/// When a frame is shown: on the client's clock, and on the scene's.
struct FrameTime {
    FrameTime(ClientTime client_now, Step scene_step = 0, double scene_steps_per_second = 0)
        : now{client_now}, step{scene_step}, steps_per_second{scene_steps_per_second} {}
    ClientTime now;
    Step step;
    double steps_per_second;  ///< 0 while the animation rests.
};

/// One frame's outcome.
struct ResidencyFrame {
    std::vector<SlotUpload> uploads;
    double lod_bias = 0;                ///< To add to every pixel's level, in the shader too.
    std::size_t needed = 0;             ///< Pages the view samples.
    std::size_t missing = 0;            ///< Of these, not resident and not given up.
    std::size_t stale = 0;              ///< Of these, resident, with a newer version to be had.
    double resident_share = 1;          ///< Of the pixels that see the plane, those that are sharp: 0 to 1.
    double mip_deficit = 0;             ///< Levels missing, averaged over the pixels that see the plane.
    std::vector<NeededPage> sampled{};  ///< All `needed`, those included that are missing.
    std::vector<std::uint32_t> ended_holds{};  ///< From this frame on the pages show these changes.
    /// Of these the pages show still what they lift, because it is too much (StandIns): a hand that drew it
    /// too would have it seen twice.
    std::vector<std::uint32_t> unlifted_holds{};
    bool is_sharp() const { return missing == 0; }
    bool is_current() const { return missing == 0 && stale == 0; }
};

/// Runs the stages in order, once a frame: what is needed, what has come, what is shown, what to ask for.
class Residency {
  public:
    /// `source` outlives this.
    Residency(Extent extent, PageSource& source, const ResidencySettings& settings);

    /// For the pages that `sampling` reads. The clip centre of `view` lies inside the extent.
    ResidencyFrame update(const PlaneView& view, FrameTime time, const Sampling& sampling = {});

    /// Changes that are drawn over the pages from the next update() on, until they say that a hold has ended,
    /// or the caller leaves it out.
    void hold(std::vector<PageHold> holds) { holds_.set(std::move(holds)); }

    /// Of each frame from now on, at least 1: see ResidencySettings.
    void set_uploads_per_frame(std::size_t most) { settings_.uploads_per_frame = most; }

    /// From now on the cache has so many slots (at least the pinned pages' and as many again). Pages that
    /// stay keep their slots but for `moves`, which the caller carries over before the next picture.
    SlotCache::Resized resize(std::size_t slots);
    /// How many resize(slots) would make.
    std::size_t cache_slots(std::size_t slots) const;

    PageTable& table() { return table_; }
    const PageTable& table() const { return table_; }
    const SlotCache& cache() const { return cache_; }
    const PageRequests& requests() const { return requests_; }
    const PageVersions& versions() const { return versions_; }
    const ResidencySettings& settings() const { return settings_; }
    Extent extent() const { return extent_; }
    /// Of the cache and of stand-ins.
    std::size_t slots() const { return cache_.capacity() + stand_ins_.most(); }

  private:
    std::size_t pinned_room() const;
    std::vector<NeededPage> need(const PlaneView& view, const Sampling& sampling);
    std::vector<NeededPage> in_windows(std::vector<NeededPage> pages) const;
    bool is_pinned(PageKey page) const { return page.level + settings_.pinned_levels > extent_.n; }
    void mark_used(const std::vector<NeededPage>& needed);
    void hear_news();
    std::vector<SlotUpload> place_arrivals(const FrameTime& time);
    std::vector<std::uint32_t> end_holds(const std::vector<NeededPage>& needed, const FrameTime& time,
                                         std::vector<SlotUpload>& uploads);
    bool is_settled(PageKey page, std::uint64_t revision) const;
    void drop_older(PageKey page, std::uint64_t revision);
    bool is_kept(PageKey page, Step step) const;
    std::optional<SlotUpload> place(ArrivedPage arrived, const FrameTime& time);
    std::vector<WantedPage> wanted(const PlaneView& view, const std::vector<NeededPage>& needed,
                                   const FrameTime& time, const Sampling& sampling);
    void watch(const std::vector<NeededPage>& needed);

    Extent extent_;
    PageSource& source_;
    ResidencySettings settings_;
    PageTable table_;
    SlotCache cache_;
    PageRequests requests_;
    PageVersions versions_;
    CameraMotion motion_;
    std::vector<ArrivedPage> early_;  ///< Whose steps are yet to come
    PageHolds holds_;
    StandIns stand_ins_;
    WatchedWindows watched_;
    double lod_bias_ = 0;
    struct Plan {
        std::optional<PlaneView> view{};
        Sampling sampling{};
        std::size_t room = 0;
        bool is_settled = false;  ///< Planned again, it would be the same
        std::vector<NeededPage> needed{};
    } plan_;  ///< The last
};

}  // namespace tessera
