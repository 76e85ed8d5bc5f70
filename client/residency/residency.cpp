#include "client/residency/residency.h"

#include <unordered_map>
#include <utility>

namespace tessera {

int window_side_for(int width_pixels) { return width_pixels <= 1200 ? 32 : width_pixels <= 2400 ? 64 : 128; }

Residency::Residency(Extent extent, PageSource& source, const ResidencySettings& settings)
    : extent_{extent},
      settings_{settings},
      table_{extent, settings.window_side},
      cache_{settings.slots},
      requests_{source, settings.requests} {}

ResidencyFrame Residency::update(const PlaneView& view, ClientTime now, const Sampling& sampling) {
    const PlanePoint& centre = view.camera().ground;
    table_.move_to(centre.x, centre.y);
    cache_.begin_frame();

    const std::vector<NeededPage> needed = need(view, sampling);
    mark_used(needed);
    ResidencyFrame frame;
    frame.uploads = place_arrivals(now);
    requests_.want(wanted(needed), now);

    frame.lod_bias = lod_bias_;
    frame.needed = needed.size();
    double pixels = 0, sharp = 0, deficit = 0;
    for (const NeededPage& page : needed) {
        pixels += page.pixels;
        const auto shown = table_.shown_for(page.key);
        const int missing = (shown ? shown->level : extent_.n + 1) - page.key.level;
        if (missing == 0) {
            sharp += page.pixels;
            continue;
        }
        deficit += page.pixels * missing;
        if (!requests_.is_given_up(page.key)) ++frame.missing;
    }
    if (pixels > 0) {
        frame.resident_share = sharp / pixels;
        frame.mip_deficit = deficit / pixels;
    }
    return frame;
}

/// Where the cache is too small for the view, coarser levels are asked for, instead of pages chasing each
/// other out of it for ever.
std::vector<NeededPage> Residency::need(const PlaneView& view, const Sampling& sampling) {
    constexpr double step = 0.25;
    constexpr std::size_t pinned_room = 21;  // 1 + 4 + 16 pages of three levels
    const std::size_t room = cache_.capacity() - pinned_room;
    std::vector<NeededPage> needed;
    const auto fits = [&](double bias, double share) {
        needed = needed_pages(view, extent_, bias, sampling);
        std::erase_if(needed, [&](const NeededPage& page) { return !table_.in_window(page.key); });
        return static_cast<double>(needed.size()) <= share * static_cast<double>(room);
    };
    // One step sharper only where that leaves a margin: the bias does not swing
    if (lod_bias_ > 0 && fits(lod_bias_ - step, 0.9)) {
        lod_bias_ -= step;
        return needed;
    }
    while (!fits(lod_bias_, 1.0) && lod_bias_ < extent_.n) lod_bias_ += step;
    return needed;
}

void Residency::mark_used(const std::vector<NeededPage>& needed) {
    for (const NeededPage& page : needed)
        if (const auto shown = table_.shown_for(page.key)) cache_.use(shown->slot);
}

std::vector<SlotUpload> Residency::place_arrivals(ClientTime now) {
    std::vector<SlotUpload> uploads;
    for (ArrivedPage& arrived : requests_.take_arrived(settings_.uploads_per_frame, now)) {
        if (cache_.find(arrived.page)) continue;
        const auto placement = cache_.insert(arrived.page, is_pinned(arrived.page));
        if (!placement) continue;  // all in use now: it will be asked for again
        if (placement->evicted) table_.hide(*placement->evicted);
        cache_.use(placement->slot);
        table_.show(arrived.page,
                    {placement->slot, arrived.page.level, static_cast<std::uint32_t>(now.count())});
        uploads.push_back({placement->slot, arrived.page, std::move(arrived.texels.value())});
    }
    return uploads;
}

/// A missing page gains its pixels × the levels that are missing there. Where many levels are missing, every
/// second level on the way is wanted too: few coarse pages serve many pixels, so they come first by their
/// gain.
std::vector<WantedPage> Residency::wanted(const std::vector<NeededPage>& needed) const {
    std::unordered_map<PageKey, double> gains;
    for (const NeededPage& page : needed) {
        const auto shown = table_.shown_for(page.key);
        const int shown_level = shown ? shown->level : extent_.n + 1;
        if (shown_level == page.key.level) continue;
        gains[page.key] += page.pixels * (shown_level - page.key.level);
        for (PageKey step = page.key; step.level + 2 < shown_level && step.level < extent_.n;) {
            step = parent(step);
            if (step.level % 2 == 0 && step.level >= page.key.level + 2)
                gains[step] += page.pixels * (shown_level - step.level);
        }
    }
    // The pinned levels cover everything: first of all, the coarsest first
    constexpr double first_of_all = 1e12;
    for (int level = extent_.n; level >= 0 && is_pinned({static_cast<std::uint8_t>(level), 0, 0}); --level) {
        const auto l = static_cast<std::uint8_t>(level);
        for (std::uint32_t y = 0; y < extent_.side_pages(l); ++y)
            for (std::uint32_t x = 0; x < extent_.side_pages(l); ++x)
                if (!cache_.find({l, x, y})) gains[{l, x, y}] = first_of_all * (level + 1);
    }
    std::vector<WantedPage> wanted;
    wanted.reserve(gains.size());
    for (const auto& [page, gain] : gains) wanted.push_back({page, gain});
    return wanted;
}

}  // namespace tessera
